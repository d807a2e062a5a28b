// SPDX-License-Identifier: GPL-3.0-or-later
// Expected scatter of the effective contrast that a camera measures, and its part of the interval of S75.
#pragma once

#include <functional>
#include <opencv2/core/types.hpp>
#include <optional>
#include <vector>

#include "acquisition/base/rng.h"
#include "bench/forecast/prediction.h"

namespace todbench {

/// Returns the variance of effective_contrast() divided by the variance of a pixel, for white noise.
/// effective_contrast() is the mean over the reference triangles of the plate, each a median over its inside minus a
/// median over its ring. 0 if no triangle is large enough.
[[nodiscard]] double contrast_variance_per_pixel(const TargetPlate& plate, double pixels_per_mm, double min_size_px);

/// Returns d ln S75 / d ln contrast at each contrast of a prediction, as join_contrast_errors() computes it from a
/// curve.
[[nodiscard]] std::vector<double> expected_contrast_effects(const std::vector<ContrastPrediction>& contrasts);

/// Noise of the contrast of a large triangle.
struct TriangleNoise {
  cv::Point2d place_px;  ///< position in the picture
  double size_px = 0;
  double temporal_k = 0;  ///< standard deviation of one measurement
  double fixed_k = 0;  ///< standard deviation due to the fixed pattern, the same in every measurement at this position
};

/// Returns the noise of the large triangles in each set-up of a plan (numbered_set_ups()). A measurement averages
/// `contrast_frames`, or the frames of a presentation if the contrast is measured in each presentation. The noise comes
/// from the file of the sensor.
[[nodiscard]] std::vector<std::vector<TriangleNoise>> contrast_noise(const Plan& plan, const ExperimentInputs& inputs,
                                                                     double delta_t_k);

/// Returns the half-width of ln S75 due to the measured contrast in one simulated run, as AdaptiveSchedule computes it
/// from contrast_error(). `noise`: of each set-up. `looks`: number of measurements in each set-up. `slope`: d ln S75 /
/// d ln contrast. `run`: white noise of the triangles. 0 if the measurements have only one triangle.
[[nodiscard]] double simulated_contrast_half_width(const std::vector<std::vector<TriangleNoise>>& noise,
                                                   const std::vector<int>& looks, double delta_t_k, double slope,
                                                   const RandomStream& run);

/// Adds the scatter of the measured contrast to the predictions of a plan with a camera, as join_contrast_errors()
/// (tod/psychometric/contrast_slope.h) adds it to the curve. `looks`: number of measurements of each contrast
/// in each set-up.
void join_contrast_scatter(std::vector<ContrastPrediction>& contrasts, const Plan& plan, const ExperimentInputs& inputs,
                           const std::vector<std::vector<int>>& looks);

/// Returns the least number of frames of the measured contrast ([measurement] contrast_frames) for which the prediction
/// of every contrast passes the test `enough`. Candidates are the number of the plan and 2 to 64 times this number.
/// Empty if no candidate passes. Errors: those of predict_plan().
[[nodiscard]] Result<std::optional<int>> enough_contrast_frames(
    Plan plan, const ExperimentInputs& inputs, const std::function<bool(const ContrastPrediction&)>& enough);

/// Returns the number of frames of the measured contrast that allows presentations to decide a limit, for a camera of
/// the predicted acuity: the scatter of the contrast then causes at most half of the half-width that the rows leave.
/// `floor_ln`: half-width of the stated rows. Empty in three cases: the number of the plan is sufficient, the stated
/// rows alone prevent the decision, or 64 times the number of the plan is not enough. Errors: those of predict_plan().
[[nodiscard]] Result<std::optional<int>> deciding_contrast_frames(const Plan& plan, const ExperimentInputs& inputs,
                                                                  const ContrastPrediction& contrast,
                                                                  double least_acuity_per_mrad, double floor_ln);

}  // namespace todbench
