// SPDX-License-Identifier: GPL-3.0-or-later
// Ranges by criteria on a target: cycles (ACQUIRE, MTDP-like) and the TTP metric. Pure functions of curves and air.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tod/psychometric/psychometric_fit.h"
#include "tod/range/log_linear_curve.h"
#include "tod/range/probability_forms.h"
#include "tod/range/transmittance.h"

namespace todbench {

/// The target in models of cycles or values.
struct CriterionTarget {
  double size_m = 0;    ///< square root of the projected area, > 0
  double contrast = 0;  ///< at the target, > 0: kelvin for an MRTD, luminance contrast for a CTF
};

/// Resolution of the target at an apparent contrast, per milliradian of its size: the highest resolved frequency, or
/// the integral of the TTP metric. Does not decrease with contrast; empty if the contrast lies below the curve.
using ResolvedPerMrad = std::function<std::optional<double>(double apparent_contrast)>;
/// ACQUIRE: the highest frequency in cycles/mrad at which the curve is at most the contrast. Above the curve's highest
/// point its last frequency, without extrapolation.
[[nodiscard]] ResolvedPerMrad resolved_cycles(LogLinearCurve curve);
/// The 2-D frequency of ACQUIRE, sqrt(f_h f_v) at the same contrast.
[[nodiscard]] ResolvedPerMrad resolved_cycles(LogLinearCurve horizontal, LogLinearCurve vertical);
/// TTP: the integral of sqrt(C / CTF) over the frequencies at which CTF < C, in 1/mrad.
[[nodiscard]] ResolvedPerMrad resolved_values(LogLinearCurve ctf);

/// Criterion of a range: number of cycles or values on the target for a probability of 50 %.
struct Criterion {
  double at_half = 0;  ///< N50 or V50, > 0
  ProbabilityForm form = ProbabilityForm::johnson;
};

/// Quantity with the larger effect on the range of a probability, for the same relative change of size or contrast.
enum class DominantLimit { resolution, contrast };
[[nodiscard]] std::string_view to_string(DominantLimit limit);

/// d ln R / d ln size and d ln R / d ln contrast at a range.
struct RangeSensitivity {
  double to_size = 0, to_contrast = 0;
  [[nodiscard]] DominantLimit dominant() const {
    return to_contrast > to_size ? DominantLimit::contrast : DominantLimit::resolution;
  }
};
/// Computes both by differences of 1 % of a function from (size factor, contrast factor) to a range; empty if the
/// function has no value.
[[nodiscard]] std::optional<RangeSensitivity> sensitivity_of(
    const std::function<std::optional<double>(double size_factor, double contrast_factor)>& range);

/// x at a range: resolution of the target over the criterion; empty outside the curve or the air's table.
[[nodiscard]] std::optional<double> criterion_ratio(const ResolvedPerMrad& resolved, const CriterionTarget& target,
                                                    const Transmittance& air, const Criterion& criterion,
                                                    double range_m);

/// The range at which a probability is reached, or the reason why there is none.
struct CriterionRange {
  std::optional<double> range_m;
  std::optional<double> at_least_m;  ///< without a range: the probability is higher up to here
  std::string reason;                ///< a sentence; empty if there is a range
  std::optional<RangeSensitivity> sensitivity;
};
/// The smallest range at which the ratio falls to that of the probability. Preconditions: values of the target and the
/// criterion > 0 and finite, 0 < probability < 1.
[[nodiscard]] CriterionRange range_for_probability(const ResolvedPerMrad& resolved, const CriterionTarget& target,
                                                   const Transmittance& air, const Criterion& criterion,
                                                   double probability);

}  // namespace todbench
