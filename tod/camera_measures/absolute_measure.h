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
  std::string plate;                   ///< name of the plate; its cut-out fills the picture
  std::vector<double> temperatures_k;  ///< temperatures of the black body, at least three; presented in order and in
                                       ///< reverse order
  int frames = 32;  ///< number of frames averaged at each temperature and each position of the source
  /// Distance by which the stage shifts the source, to separate the fixed patterns of camera and source. 0: not
  /// separated.
  int shift_px = 8;
  double pixel_mm = 0;      ///< pixel pitch on the plate
  double pixel_aspect = 1;  ///< height of a pixel divided by its width, which is pixel_mm
  double source_u_k = 0;    ///< standard uncertainty of the expected temperature
  /// Returns the temperature that the sensor inside the camera reports, in degrees Celsius. May be null, or return
  /// empty.
  std::function<std::optional<double>()> camera_temperature_c{};
  /// Returns the temperature that a correct camera shows through a collimator, for a temperature of the black body.
  /// Null: the two temperatures are equal.
  std::function<double(double black_body_k)> expected_k{};
};

/// Results at one temperature, averaged over both passes.
struct AbsoluteLevel {
  double set_k = 0;
  double said_k = 0;      ///< reading of the black body
  double expected_k = 0;  ///< temperature that a correct camera shows
  double seen_k = 0;      ///< mean of the picture
  /// Observed value of the second pass minus that of the first pass, corrected by the readings of the black body.
  double difference_k = 0;
  Estimate pattern_k{};    ///< standard deviation of the fixed pattern without shading
  bool saturated = false;  ///< the camera saturated: the other values are not stated
  /// Temperature of the camera according to the sensor inside the camera; empty: not reported.
  std::optional<double> camera_c{};
};

/// Result of measure_absolute().
struct AbsoluteMeasure {
  std::string plate;
  int frames = 0;
  std::vector<AbsoluteLevel> levels{};
  /// Standard deviation of one observed temperature, from the differences of the two passes.
  double repeatability_k = 0;
  double u_k = 0;  ///< standard uncertainty of seen_k of a level, with `degrees_of_freedom`
  int degrees_of_freedom = 0;
  double source_u_k = 0;  ///< standard uncertainty of the expected temperature, as in the options
  /// Straight line of the observed temperature as a function of the expected temperature: slope of the line, and
  /// deviation of the line from the expected temperature at the middle of the range.
  Estimate slope{}, offset_k{};
  double nonlinearity_percent = 0;  ///< largest residual of the line, in percent of the span of the line
  Estimate prnu_percent{};          ///< standard deviation of the responsivity over the pixels, without shading
  /// Fixed pattern at the middle temperature, separately for the camera and for the source. Empty: not separated.
  std::optional<Estimate> camera_pattern_k{}, source_pattern_k{};
  /// Linear gradient across the picture, largest minus smallest value. The gradient may be due to the camera or to the
  /// source; the measurement does not distinguish camera and source.
  std::optional<double> undetermined_slope_k{};
  /// Temperatures of the lowest and the highest count, if the scale states them.
  std::optional<double> lowest_k{}, highest_k{};
  std::optional<double> dynamic_range_db{};  ///< 20 log10 of ((highest_k - lowest_k) / temporal noise of a pixel)
  /// Half-width of the 95 % interval of dynamic_range_db, due to the error of the noise.
  double dynamic_range_half_db = 0;
  std::vector<std::string> reasons{};  ///< reasons for absent values

  /// Returns the level with the largest magnitude of the deviation. Precondition: at least one level is not saturated.
  [[nodiscard]] const AbsoluteLevel& worst() const;
  /// Returns the deviation of a level, observed minus expected temperature. The 95 % interval includes repeatability
  /// and the uncertainty of the source.
  [[nodiscard]] Estimate deviation_k(const AbsoluteLevel& level) const;
  /// Returns the inequivalent temperature difference (IETD): the largest fixed pattern of the levels, divided by the
  /// slope.
  [[nodiscard]] Estimate ietd_k() const;
};

/// Shifts the source and sets its temperature. The function returns when shift and temperature are reached.
using ShowTemperature = std::function<Result<PresentedTarget>(double temperature_k, cv::Point2d shift_mm)>;

/// Measures the camera. Errors: those of `show` and of FrameTaker::average(); `invalid_input` (fewer than three
/// temperatures at which the camera does not saturate).
[[nodiscard]] Result<AbsoluteMeasure> measure_absolute(FrameTaker& taker, const ShowTemperature& show,
                                                       const AbsoluteOptions& options, const std::stop_token& stop);

/// Mean pictures of the two passes. Their noise is independent, so an estimate from their product is not biased by
/// noise.
struct PatternPair {
  cv::Mat1d first, second;  ///< each minus its mean and shading
};
/// Returns the root of the mean product of the two pictures, with its 95 % interval; 0 if the mean product is negative.
[[nodiscard]] Estimate pattern_sd(const PatternPair& pair);

}  // namespace todbench
