// SPDX-License-Identifier: GPL-3.0-or-later
// What limits the acuity of a simulated sensor with its display and observer: sampling, noise, display, eye or light.
#pragma once

#include <array>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "bench/run/experiment_inputs.h"

namespace todbench {

/// Something that costs acuity.
enum class LimitingFactor {
  sampling,      ///< distance of the sensor's samples
  sensor_noise,  ///< all noise of the sensor
  display,       ///< spot, interpolation, veil, black level and gain of the display
  eye,           ///< noise and uncertainty of the person; for an observer without an eye its blur and internal noise
  light,         ///< luminance of the display; none for an observer without an eye
};
inline constexpr std::array all_limiting_factors{LimitingFactor::sampling, LimitingFactor::sensor_noise,
                                                 LimitingFactor::display, LimitingFactor::eye, LimitingFactor::light};
[[nodiscard]] std::string_view to_string(LimitingFactor factor);

/// Cost of one factor: 100 (S75 / S75 without it - 1), in percent.
struct FactorCost {
  LimitingFactor factor = LimitingFactor::sampling;
  double percent = 0;
};

struct AcuityLimits {
  double delta_t_k = 0;
  double s75_mrad = 0;
  std::vector<FactorCost> costs;  ///< the largest first
};

/// Leaves out one factor after the other, by direct estimates of draft accuracy (error about 1 %): sampling: twice as
/// many samples at the same size on the display; noise: none; display: no spot, veil or interpolation, black of 0 and
/// the largest contrast; eye: no noise of its own; light: a hundred times the luminance. Contrasts without a threshold
/// are left out. Errors: `interrupted`.
[[nodiscard]] Result<std::vector<AcuityLimits>> acuity_limits(const ExperimentInputs& inputs,
                                                              const std::vector<double>& delta_t_k,
                                                              std::stop_token stop);

/// "at 0.23 K the sensor noise limits the acuity: ...", with every cost.
[[nodiscard]] std::string in_words(const AcuityLimits& limits);

}  // namespace todbench
