// SPDX-License-Identifier: GPL-3.0-or-later
// Measurement of a camera in front of a black body of absolute temperature: accuracy, non-uniformity, range and
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
  std::string plate;                   ///< its cut-out fills the picture
  std::vector<double> temperatures_k;  ///< of the black body, at least three; shown in order and in reverse order
  int frames = 32;                     ///< averaged at each temperature and place
  int shift_px = 8;     ///< of the source on the stage, to separate the patterns of camera and source; 0: not separated
  double pixel_mm = 0;  ///< pixel pitch on the plate
  double pixel_aspect = 1;  ///< height of a pixel over its width, which is pixel_mm
  double source_u_k = 0;    ///< standard uncertainty of the expected temperature
  /// Temperature that the camera's own sensor reports, in degrees Celsius; may be empty, or return nothing.
  std::function<std::optional<double>()> camera_temperature_c{};
  /// Temperature that a correct camera shows for a temperature of the black body, through a collimator; empty: both are
  /// equal.
  std::function<double(double black_body_k)> expected_k{};
};

/// One temperature, mean of both passes.
struct AbsoluteLevel {
  double set_k = 0;
  double said_k = 0;        ///< reading of the black body
  double expected_k = 0;    ///< for a correct camera
  double seen_k = 0;        ///< mean of the picture
  double difference_k = 0;  ///< seen in the second pass minus first pass, corrected by the readings
  Estimate pattern_k{};     ///< standard deviation of the fixed pattern without shading
  bool saturated = false;   ///< the camera saturated: the other numbers are not stated
  /// Temperature of the camera by its own sensor; empty: not reported.
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
  /// Line through seen over expected: slope, and deviation at the middle of the range.
  Estimate slope{}, offset_k{};
  double nonlinearity_percent = 0;
  Estimate prnu_percent{};  ///< standard deviation of the responsivity over the pixels, without shading
  /// Fixed pattern at the middle temperature: of the camera alone and of the source; empty: not separated.
  std::optional<Estimate> camera_pattern_k{}, source_pattern_k{};
  /// Slope over the picture that cannot be assigned to camera or source; largest minus smallest value.
  std::optional<double> undetermined_slope_k{};
  /// Temperatures of the lowest and the highest count, if the scale states them.
  std::optional<double> lowest_k{}, highest_k{};
  std::optional<double> dynamic_range_db{};  ///< 20 log10 of their difference over the temporal noise of a pixel
  double dynamic_range_half_db = 0;          ///< half-width of its 95 % interval, by the error of the noise
  std::vector<std::string> reasons{};        ///< for absent values

  /// Level with the largest deviation of either sign. Precondition: a level that is not saturated.
  [[nodiscard]] const AbsoluteLevel& worst() const;
  /// Deviation of a level, seen minus expected, with the 95 % interval of repeatability and source.
  [[nodiscard]] Estimate deviation_k(const AbsoluteLevel& level) const;
  /// Largest fixed pattern of the levels, over the slope: inequivalent temperature difference (IETD).
  [[nodiscard]] Estimate ietd_k() const;
};

/// Shows the plate with the source shifted and at a temperature; returns once both are reached.
using ShowTemperature = std::function<Result<PresentedTarget>(double temperature_k, cv::Point2d shift_mm)>;

/// Measures the camera. Errors: those of `show` and of FrameTaker::average(); `invalid_input` (fewer than three
/// temperatures that do not saturate the camera).
[[nodiscard]] Result<AbsoluteMeasure> measure_absolute(FrameTaker& taker, const ShowTemperature& show,
                                                       const AbsoluteOptions& options, const std::stop_token& stop);

/// Pictures of two passes, as independent halves: an estimate without the bias of noise.
struct PatternPair {
  cv::Mat1d first, second;  ///< each without mean and shading
};
/// Root of the mean product of both, with its 95 % interval; 0 if it is negative.
[[nodiscard]] Estimate pattern_sd(const PatternPair& pair);

}  // namespace todbench
