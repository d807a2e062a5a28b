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
  std::string name;     ///< text for a sentence: "the acuity form", "a free lapse rate of 0.031"
  double ln_shift = 0;  ///< ln(threshold of the alternative / threshold of the fit)
};

/// Returns the best of the alternatives; empty if none has a threshold. One is the other form. If `options` fix the
/// lapse, a free lapse is tried with both forms. The last one is a curve that adds a bend and a twist to the model (a
/// cubic in ln size instead of the straight line), with the lapse of the fit and with larger lapses up to 0.1.
/// `fit`: fit of the levels with `options`; it has a threshold.
[[nodiscard]] std::optional<Alternative> best_alternative(std::span<const Level> levels, const PsychometricFit& fit,
                                                          const FitOptions& options);

}  // namespace todbench
