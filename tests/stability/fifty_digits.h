// SPDX-License-Identifier: GPL-3.0-or-later
// The psychometric function and its maximum in 50-digit arithmetic, from the definition: the second opinion.
#pragma once

#include <array>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <vector>

#include "tod/psychometric/psychometric_fit.h"

namespace todbench::testing {

using Digits = boost::multiprecision::cpp_bin_float_50;

/// ln likelihood of the size form at (ln threshold, ln slope), lapse fixed.
inline Digits log_likelihood_50(const std::vector<Level>& levels, const Digits& t, const Digits& q,
                                const Digits& lapse) {
  const Digits guess = Digits(1) / 4, amplitude = 1 - guess - lapse;
  const Digits kappa = log(amplitude / (Digits(1) / 4 - lapse)), slope = exp(q);
  Digits sum = 0;
  for (const Level& level : levels) {
    if (level.total == 0) continue;
    Digits rest = 1;  // exp(-z)
    if (level.size > 0) rest = exp(-kappa * exp(slope * (log(Digits(level.size)) - t)));
    // 1 - rest loses digits for z below 1e-25; then psi is the chance level to 25 digits, which is all that is needed.
    const Digits right = guess + amplitude * (1 - rest), wrong = lapse + amplitude * rest;
    if (level.correct > 0) sum += Digits(level.correct) * log(right);
    if (level.correct < level.total) sum += Digits(level.total - level.correct) * log(wrong);
  }
  return sum;
}

/// Maximum of the likelihood by Newton's method with differences, from a start near it. With a step of 1e-12
/// differences are good to 1e-24 of a second derivative and the fixed point to better than 1e-20.
struct Maximum50 {
  Digits t, q, log_likelihood;
  bool converged = false;
};
inline Maximum50 maximum_50(const std::vector<Level>& levels, double start_t, double start_q, double lapse) {
  const Digits h("1e-12"), l(lapse);
  Maximum50 at{Digits(start_t), Digits(start_q), Digits(0), false};
  const auto f = [&](const Digits& t, const Digits& q) { return log_likelihood_50(levels, t, q, l); };
  for (int iteration = 0; iteration < 12 && !at.converged; ++iteration) {
    const Digits mid = f(at.t, at.q), tp = f(at.t + h, at.q), tm = f(at.t - h, at.q), qp = f(at.t, at.q + h),
                 qm = f(at.t, at.q - h);
    const Digits pp = f(at.t + h, at.q + h), mm = f(at.t - h, at.q - h);
    const Digits gt = (tp - tm) / (2 * h), gq = (qp - qm) / (2 * h);
    const Digits tt = (tp - 2 * mid + tm) / (h * h), qq = (qp - 2 * mid + qm) / (h * h);
    const Digits tq = (pp - tp - qp + 2 * mid - tm - qm + mm) / (2 * h * h);
    const Digits determinant = tt * qq - tq * tq;
    const Digits step_t = (gq * tq - gt * qq) / determinant, step_q = (gt * tq - gq * tt) / determinant;
    at.t += step_t;
    at.q += step_q;
    at.converged = abs(step_t) + abs(step_q) < Digits("1e-18");
  }
  at.log_likelihood = f(at.t, at.q);
  return at;
}

/// u = b (ln x - t) at which the size form without lapse has probability p: z = -ln((1 - p) / 0.75), u = ln(z / ln 3).
inline Digits exponent_at(const Digits& p) {
  return log(-log((1 - p) * 4 / 3) / log(Digits(3)));
}

}  // namespace todbench::testing
