// SPDX-License-Identifier: GPL-3.0-or-later
// Factors that limit the acuity, and thresholds of an operator at the display of the plan.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/text/json.h"

namespace todbench {

class JsonFields;

/// Factor that reduces the acuity.
enum class LimitingFactor {
  sampling,      ///< distance between the samples of the sensor
  sensor_noise,  ///< all noise of the sensor
  display,       ///< spot, interpolation, veil, black level and gain of the display
  eye,           ///< noise and uncertainty of the person
  light,         ///< luminance of the display
  observer,      ///< blur and internal noise of an observer without an eye, in place of display, eye and light
};
inline constexpr std::array all_limiting_factors{LimitingFactor::sampling, LimitingFactor::sensor_noise,
                                                 LimitingFactor::display,  LimitingFactor::eye,
                                                 LimitingFactor::light,    LimitingFactor::observer};
/// Returns the name of the enumerator.
[[nodiscard]] std::string_view to_string(LimitingFactor factor);

/// Cost of one factor in percent: 100 (S75 / S75' - 1), with S75' the threshold without this factor.
struct FactorCost {
  LimitingFactor factor = LimitingFactor::sampling;
  double percent = 0;
  bool operator==(const FactorCost&) const = default;
};

/// Threshold at one contrast, and the cost of each factor.
struct AcuityLimits {
  double delta_t_k = 0;
  double s75_mrad = 0;
  std::vector<FactorCost> costs;  ///< the largest first
  bool operator==(const AcuityLimits&) const = default;
};

/// Returns "at 0.23 K the sensor noise limits the acuity: ...", with every cost.
[[nodiscard]] std::string in_words(const AcuityLimits& limits);
/// Returns the value of the key "acuity_limits" in the JSON of commands.
[[nodiscard]] Json acuity_limits_json(const std::vector<AcuityLimits>& limits);

/// Threshold of an observer with an eye that views the pictures of the simulated sensor, by the direct estimate.
struct DisplayedPoint {
  double delta_t_k = 0;
  double s75_mrad = 0;
  /// Range of S75 over the open parameters of the observer (hvs/observer/open_parameters.h); not a confidence interval.
  std::optional<std::pair<double, double>> spread_mrad{};
  bool operator==(const DisplayedPoint&) const = default;
};

/// Record that is stored with the results of a session. The record does not affect the verdict.
struct DisplayRecord {
  std::string observer;  ///< name of an observer with an eye
  /// Empty if this observer gave the answers of the session. The curve of the session then contains these thresholds.
  std::vector<DisplayedPoint> points;
  std::vector<AcuityLimits> limits;
  bool operator==(const DisplayRecord&) const = default;
};
/// Describes the fields of the record.
void display_fields(JsonFields& json, DisplayRecord& record);

}  // namespace todbench
