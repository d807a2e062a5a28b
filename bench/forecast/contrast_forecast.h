// SPDX-License-Identifier: GPL-3.0-or-later
// Expected scatter of the effective contrast that a camera measures, and its part of the interval of S75.
#pragma once

#include <vector>

#include "bench/forecast/prediction.h"

namespace todbench {

/// Returns the variance of effective_contrast() over that of a pixel of white noise: the mean over the reference
/// triangles of the plate, each a median over its inside minus a median over its ring. 0 if no triangle is large
/// enough.
[[nodiscard]] double contrast_variance_per_pixel(const TargetPlate& plate, double pixels_per_mm, double min_size_px);

/// Adds the scatter of the measured contrast to the predictions of a plan with a camera, as join_contrast_errors()
/// (bench/twin/camera_surrogate.h) adds it to the curve. `presentations`: their numbers in each set-up, by contrast of
/// the plan. A set-up measures each contrast that it shows once, or in every presentation if these have contrasts of
/// their own. The noise is that of the sensor's file: temporal noise over the frames, and its fixed pattern.
void join_contrast_scatter(std::vector<ContrastPrediction>& contrasts, const Plan& plan, const ExperimentInputs& inputs,
                           const std::vector<std::vector<int>>& presentations);

}  // namespace todbench
