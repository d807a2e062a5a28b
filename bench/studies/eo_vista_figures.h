// SPDX-License-Identifier: GPL-3.0-or-later
// Results of the EO-VISTA paper, compared with thresholds of this program.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "bench/report/reproduction_page.h"

namespace todbench {

/// Contrasts of the paper, in kelvin.
inline constexpr std::array eo_vista_contrasts_k{16.9, 1.93, 0.23};

/// Names of sensors and observers in a reproduction.
namespace eo_vista {
inline constexpr const char* normal = "SC2000";
inline constexpr const char* microscan = "SC2000 + microscan";
inline constexpr const char* still = "emulated camera, still";
inline constexpr const char* dsr2 = "emulated camera + DSR2";
inline constexpr const char* dsr2_exact = "emulated camera + DSR2 of exact half pitches";
inline constexpr const char* hvs = "hvs-1";
inline constexpr const char* human = "human-like-1";
}  // namespace eo_vista

/// Returns every figure of sections 4.1 and 4.2, from the thresholds of all sensors and observers and the ranges of the
/// observer `hvs`. `graded_ranges`: ranges from the thresholds of by_graded_answers().
[[nodiscard]] std::vector<ReproducedFigure> eo_vista_figures(const std::vector<ReproducedThreshold>& thresholds,
                                                             const std::vector<ReproducedRange>& ranges,
                                                             const std::vector<ReproducedRange>& graded_ranges = {});

/// Returns the thresholds. A value from graded answers, if there is one, replaces the value from binary answers.
[[nodiscard]] std::vector<ReproducedThreshold> by_graded_answers(std::vector<ReproducedThreshold> thresholds);

/// Ratio a / b of two acuities with its 95 % interval, for independent errors on the logarithmic scale.
struct AcuityRatio {
  std::optional<double> value;
  Interval ci95;
};
/// Returns the ratio of the acuities of two thresholds; empty if one is missing.
[[nodiscard]] AcuityRatio acuity_ratio(const ReproducedThreshold& a, const ReproducedThreshold& b);

}  // namespace todbench
