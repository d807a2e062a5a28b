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
  std::string name;     ///< phrase for reports: "the acuity form", "a free lapse rate of 0.031"
  double ln_shift = 0;  ///< ln(threshold of the alternative / threshold of the fit)
};

/// Returns the best alternative; empty if no alternative has a threshold. The alternatives are: the other
/// PsychometricForm; both forms with a free lapse, if `options` fix the lapse; the model with a cubic in ln size
/// instead of the straight line, with the lapse of the fit and with larger lapses up to 0.1. `fit`: fit of the levels
/// with `options`. Precondition: the fit has a threshold.
[[nodiscard]] std::optional<Alternative> best_alternative(std::span<const Level> levels, const PsychometricFit& fit,
                                                          const FitOptions& options);

}  // namespace todbench
