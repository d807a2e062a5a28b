// SPDX-License-Identifier: GPL-3.0-or-later
// Computes ranges from criteria for a target: cycles (ACQUIRE, MTDP-like) or values (TTP metric). Pure functions of
// curves and air.
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

/// Target of a model that uses cycles or values.
struct CriterionTarget {
  double size_m = 0;    ///< square root of the projected area, > 0
  double contrast = 0;  ///< contrast at the target, > 0; in kelvin for an MRTD, luminance contrast for a CTF
};

/// Resolution at an apparent contrast, per milliradian of the size of the target: the highest resolved frequency, or
/// the integral of the TTP metric. The resolution does not decrease with increasing contrast. Empty if the contrast is
/// below the curve.
using ResolvedPerMrad = std::function<std::optional<double>(double apparent_contrast)>;
/// Returns the resolution for ACQUIRE: the highest frequency in cycles/mrad at which the value of the curve is at most
/// the contrast. If the contrast is above all values of the curve, the resolution is the last frequency, without
/// extrapolation.
[[nodiscard]] ResolvedPerMrad resolved_cycles(LogLinearCurve curve);
/// Returns the resolution for the 2-D frequency of ACQUIRE, sqrt(f_h f_v) at the same contrast.
[[nodiscard]] ResolvedPerMrad resolved_cycles(LogLinearCurve horizontal, LogLinearCurve vertical);
/// Returns the resolution for TTP at contrast C: integral of sqrt(C / CTF) over frequencies with CTF < C, in 1/mrad.
[[nodiscard]] ResolvedPerMrad resolved_values(LogLinearCurve ctf);

/// Criterion of a range: number of cycles or values on the target at which the probability is 50 %.
struct Criterion {
  double at_half = 0;  ///< N50 or V50, > 0
  ProbabilityForm form = ProbabilityForm::johnson;
};

/// The quantity whose relative change has the larger effect on the range.
enum class DominantLimit { resolution, contrast };
[[nodiscard]] std::string_view to_string(DominantLimit limit);

/// d ln R / d ln size and d ln R / d ln contrast at a range R.
struct RangeSensitivity {
  double to_size = 0, to_contrast = 0;
  [[nodiscard]] DominantLimit dominant() const {
    return to_contrast > to_size ? DominantLimit::contrast : DominantLimit::resolution;
  }
};
/// Computes both sensitivities from differences of 1 %. `range`: function of (size factor, contrast factor) that
/// returns a range. Empty if `range` returns no value.
[[nodiscard]] std::optional<RangeSensitivity> sensitivity_of(
    const std::function<std::optional<double>(double size_factor, double contrast_factor)>& range);

/// Returns the ratio x at a range: number of cycles or values on the target divided by the criterion. Empty outside the
/// curve or outside the table of the air.
[[nodiscard]] std::optional<double> criterion_ratio(const ResolvedPerMrad& resolved, const CriterionTarget& target,
                                                    const Transmittance& air, const Criterion& criterion,
                                                    double range_m);

/// The range at which a probability is reached, or the reason why there is no range.
struct CriterionRange {
  std::optional<double> range_m;
  std::optional<double> at_least_m;  ///< if there is no range: distance up to which the probability is higher
  std::string reason;                ///< a sentence; empty if there is a range
  std::optional<RangeSensitivity> sensitivity;
};
/// Returns the smallest range at which criterion_ratio() decreases to the ratio for the probability. Preconditions:
/// values of target and criterion > 0 and finite, 0 < probability < 1.
[[nodiscard]] CriterionRange range_for_probability(const ResolvedPerMrad& resolved, const CriterionTarget& target,
                                                   const Transmittance& air, const Criterion& criterion,
                                                   double probability);

}  // namespace todbench
