// SPDX-License-Identifier: GPL-3.0-or-later
// What limits the acuity, and the thresholds as an operator at the display of the plan would see them.
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

/// Something that costs acuity.
enum class LimitingFactor {
  sampling,      ///< distance of the sensor's samples
  sensor_noise,  ///< all noise of the sensor
  display,       ///< spot, interpolation, veil, black level and gain of the display
  eye,           ///< noise and uncertainty of the person
  light,         ///< luminance of the display
  observer,      ///< blur and internal noise of an observer without an eye, which has none of the three before
};
inline constexpr std::array all_limiting_factors{LimitingFactor::sampling, LimitingFactor::sensor_noise,
                                                 LimitingFactor::display,  LimitingFactor::eye,
                                                 LimitingFactor::light,    LimitingFactor::observer};
[[nodiscard]] std::string_view to_string(LimitingFactor factor);

/// Cost of one factor: 100 (S75 / S75 without it - 1), in percent.
struct FactorCost {
  LimitingFactor factor = LimitingFactor::sampling;
  double percent = 0;
  bool operator==(const FactorCost&) const = default;
};

struct AcuityLimits {
  double delta_t_k = 0;
  double s75_mrad = 0;
  std::vector<FactorCost> costs;  ///< the largest first
  bool operator==(const AcuityLimits&) const = default;
};

/// "at 0.23 K the sensor noise limits the acuity: ...", with every cost.
[[nodiscard]] std::string in_words(const AcuityLimits& limits);
/// "acuity_limits" of the commands.
[[nodiscard]] Json acuity_limits_json(const std::vector<AcuityLimits>& limits);

/// Threshold of an observer with an eye behind the simulated sensor, by the direct estimate.
struct DisplayedPoint {
  double delta_t_k = 0;
  double s75_mrad = 0;
  /// Over the observer's open parameters (hvs/observer/open_parameters.h); no confidence interval.
  std::optional<std::pair<double, double>> spread_mrad{};
  bool operator==(const DisplayedPoint&) const = default;
};

/// Beside the results of a session, never in its verdict.
struct DisplayRecord {
  std::string observer;                ///< with an eye
  std::vector<DisplayedPoint> points;  ///< empty: the observer decides itself, and the curve has its thresholds
  std::vector<AcuityLimits> limits;
  bool operator==(const DisplayRecord&) const = default;
};
void display_fields(JsonFields& json, DisplayRecord& record);

}  // namespace todbench
