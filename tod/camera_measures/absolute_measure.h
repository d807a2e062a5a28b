// SPDX-License-Identifier: GPL-3.0-or-later
// Measurement of a camera in front of a black body of known absolute temperature: accuracy, non-uniformity, range and
// repeatability.
#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "acquisition/base/interval.h"
#include "acquisition/base/result.h"
#include "tod/measurement/frame_taker.h"
#include "tod/plate/target_plate.h"
#include "tod/presentation/target.h"

namespace todbench {

/// Options of measure_absolute().
struct AbsoluteOptions {
  std::string plate;                   ///< plate whose cut-out fills the picture
  std::vector<double> temperatures_k;  ///< of the black body, at least three; presented in order and in reverse order
  int frames = 32;                     ///< averaged at each temperature and place
  int shift_px = 8;         ///< shift of the source by the stage, to separate the patterns of camera and source; 0: not
                            ///< separated
  double pixel_mm = 0;      ///< pixel pitch on the plate
  double pixel_aspect = 1;  ///< height of a pixel over its width, which is pixel_mm
  double source_u_k = 0;    ///< standard uncertainty of the expected temperature
  /// Returns the temperature that the camera's own sensor reports, in degrees Celsius. May be null, or return empty.
  std::function<std::optional<double>()> camera_temperature_c{};
  /// Returns the temperature that a correct camera shows for a temperature of the black body, through a collimator.
  /// Null: both are equal.
  std::function<double(double black_body_k)> expected_k{};
};

/// One temperature; values are means of both passes.
struct AbsoluteLevel {
  double set_k = 0;
  double said_k = 0;        ///< reading of the black body
  double expected_k = 0;    ///< for a correct camera
  double seen_k = 0;        ///< mean of the picture
  double difference_k = 0;  ///< observed value in the second pass minus first pass, corrected by the readings
  Estimate pattern_k{};     ///< standard deviation of the fixed pattern without shading
  bool saturated = false;   ///< the camera saturated: the other values are not stated
  /// Temperature of the camera according to its own sensor; empty: not reported.
  std::optional<double> camera_c{};
};

/// Result of measure_absolute().
struct AbsoluteMeasure {
  std::string plate;
  int frames = 0;
  std::vector<AbsoluteLevel> levels{};
  double repeatability_k = 0;  ///< standard deviation of one reading, from both passes
  double u_k = 0;              ///< standard uncertainty of seen_k of a level, with `degrees_of_freedom`
  int degrees_of_freedom = 0;
  double source_u_k = 0;  ///< as in the options
  /// Line of observed over expected temperature: slope, and deviation at the middle of the range.
  Estimate slope{}, offset_k{};
  double nonlinearity_percent = 0;
  Estimate prnu_percent{};  ///< standard deviation of the responsivity over the pixels, without shading
  /// Fixed pattern at the middle temperature: of the camera alone and of the source; empty: not separated.
  std::optional<Estimate> camera_pattern_k{}, source_pattern_k{};
  /// Slope over the picture that cannot be assigned to camera or source: largest minus smallest value.
  std::optional<double> undetermined_slope_k{};
  /// Temperatures of the lowest and the highest count, if the scale states them.
  std::optional<double> lowest_k{}, highest_k{};
  std::optional<double> dynamic_range_db{};  ///< 20 log10 of (difference of the two / temporal noise of a pixel)
  double dynamic_range_half_db = 0;          ///< half-width of its 95 % interval, from the error of the noise
  std::vector<std::string> reasons{};        ///< reasons for absent values

  /// Returns the level with the largest deviation of either sign. Precondition: a level that is not saturated.
  [[nodiscard]] const AbsoluteLevel& worst() const;
  /// Returns the deviation of a level, observed minus expected, with a 95 % interval that includes repeatability and
  /// source.
  [[nodiscard]] Estimate deviation_k(const AbsoluteLevel& level) const;
  /// Returns the inequivalent temperature difference (IETD): the largest fixed pattern of the levels, divided by the
  /// slope.
  [[nodiscard]] Estimate ietd_k() const;
};

/// Shows the plate with the source shifted and at a temperature; returns once both are reached.
using ShowTemperature = std::function<Result<PresentedTarget>(double temperature_k, cv::Point2d shift_mm)>;

/// Measures the camera. Errors: those of `show` and of FrameTaker::average(); `invalid_input` (fewer than three
/// temperatures at which the camera does not saturate).
[[nodiscard]] Result<AbsoluteMeasure> measure_absolute(FrameTaker& taker, const ShowTemperature& show,
                                                       const AbsoluteOptions& options, const std::stop_token& stop);

/// Pictures of the two passes as independent halves, for an estimate that noise does not bias.
struct PatternPair {
  cv::Mat1d first, second;  ///< each without mean and shading
};
/// Returns the root of the mean product of both pictures, with its 95 % interval; 0 if the mean product is negative.
[[nodiscard]] Estimate pattern_sd(const PatternPair& pair);

}  // namespace todbench
