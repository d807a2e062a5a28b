// SPDX-License-Identifier: GPL-3.0-or-later
// Alternative functions for the same answers, and their thresholds.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "tod/psychometric/psychometric_likelihood.h"

namespace todbench {

/// The alternative function that describes the answers best, by likelihood and number of parameters (Akaike 1974).
struct Alternative {
  std::string name;     ///< for a sentence: "the acuity form", "a free lapse rate of 0.031"
  double ln_shift = 0;  ///< ln(its threshold / threshold of the fit)
};

/// Tries the other form, a free lapse, both, and a curve that adds a bend and a twist to the model (a cubic in ln size
/// instead of the straight line) with fixed and with free lapse. Empty if none has a threshold. `fit`: fit of the
/// levels with `options`; it has a threshold.
[[nodiscard]] std::optional<Alternative> best_alternative(std::span<const Level> levels, const PsychometricFit& fit,
                                                          const FitOptions& options);

}  // namespace todbench
