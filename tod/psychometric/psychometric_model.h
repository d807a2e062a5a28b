// SPDX-License-Identifier: GPL-3.0-or-later
// The psychometric function: numerically stable logarithms of psi and 1 - psi, and their derivatives.
#pragma once

#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

inline constexpr double chance_level = 0.25;  ///< four alternatives
inline constexpr double min_slope = 0.1;      ///< domain of the slope b
inline constexpr double max_slope = 50;
inline constexpr double max_free_lapse = 0.1;  ///< domain of a free lapse

/// A form of the function at one lapse: psi = g + A H and 1 - psi = l + A (1 - H) with g = chance level, l = lapse and
/// A = 1 - g - l. H is 1 - exp(-z) (size form) or exp(-z) (acuity form), where z = kappa exp(u) and u = +-b (ln x - ln
/// x75) with size x, threshold x75 and slope b. The value of kappa(l) is chosen to make psi(x75) = 0.75.
struct Link {
  PsychometricForm form = PsychometricForm::size;
  double lapse = 0;
  double amplitude = 0.75;  ///< A
  double kappa = 0;         ///< z at the threshold
  double ln_kappa = 0;
  double d_ln_kappa = 0;   ///< first derivative of ln kappa with respect to the lapse
  double d2_ln_kappa = 0;  ///< second derivative
  double sign = 1;         ///< sign of u: +1 for the size form, -1 for the acuity form
};
/// Creates a link. Precondition: `lapse` in [0, 0.1].
[[nodiscard]] Link make_link(PsychometricForm form, double lapse);

/// ln psi and ln(1 - psi).
struct LogProbabilities {
  double right = 0, wrong = 0;
};
/// Computes both logarithms at u without rounding psi to 1, so ln(1 - psi) is also accurate if psi is very close to 1.
/// Arguments above 700 are replaced by 700.
[[nodiscard]] LogProbabilities log_probabilities(const Link& link, double u);

/// Value of ln psi or ln(1 - psi), and partial derivatives with respect to w = ln z and to the lapse at constant w.
struct LogTerm {
  double value = 0, w = 0, ww = 0, l = 0, ll = 0, wl = 0;
};
/// Contributions of a correct answer (ln psi) and of a wrong answer (ln(1 - psi)).
struct AnswerTerms {
  LogTerm right, wrong;
};
/// Computes the contributions at u. Values above 300 are replaced by 300, so second derivatives times counts never
/// overflow.
[[nodiscard]] AnswerTerms answer_terms(const Link& link, double u);

}  // namespace todbench
