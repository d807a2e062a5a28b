// Other functions for the same answers: where would they put the threshold?
#pragma once

#include <optional>
#include <span>
#include <string>

#include "tod/psychometric/psychometric_likelihood.h"

namespace todbench {

/// The function of the alternatives that describes the answers best, by likelihood and number of parameters (Akaike
/// 1974).
struct Alternative {
  std::string name;               ///< in a sentence: "the acuity form", "a free lapse of 0.031"
  double ln_shift = 0;            ///< ln of its threshold over that of the fit
  double ln_likelihood_gain = 0;  ///< over the fit
};

/// Tries the other form, a free lapse, both, and a curve with a bend and a twist more than the model (a cubic in ln
/// size in place of the straight line), without and with a free lapse. Nothing where none has a threshold. `fit`: of
/// the levels, with a threshold, by `options`.
[[nodiscard]] std::optional<Alternative> best_alternative(std::span<const Level> levels, const PsychometricFit& fit,
                                                          const FitOptions& options);

}  // namespace todbench
