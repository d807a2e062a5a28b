// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/enhance/unseen_differences.h"

#include <algorithm>
#include <boost/math/special_functions/beta.hpp>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

namespace todbench {
namespace {

using TrialsOfPresentations = std::map<std::int64_t, std::vector<const Trial*>>;

TrialsOfPresentations by_presentation(std::span<const Trial> trials, double set_delta_t_k) {
  TrialsOfPresentations found;
  for (const Trial& trial : trials) {
    if (same_contrast(trial.set_delta_t_k, set_delta_t_k)) found[trial.presentation].push_back(&trial);
  }
  return found;
}

}  // namespace

PairedAnswers paired_answers(std::span<const Trial> with, std::span<const Trial> without, double set_delta_t_k) {
  const auto a = by_presentation(with, set_delta_t_k), b = by_presentation(without, set_delta_t_k);
  PairedAnswers found{.identical = true};
  bool scored = false;
  for (const auto& [presentation, trials] : b) {
    const auto other = a.find(presentation);
    if (other == a.end()) continue;
    found.identical = found.identical && trials.size() == other->second.size();
    for (std::size_t i = 0; i < std::min(trials.size(), other->second.size()); ++i) {
      const Trial &one = *trials[i], &two = *other->second[i];
      ++found.count;
      found.differing += one.correct() != two.correct() ? 1 : 0;
      found.identical = found.identical && one.answer == two.answer && one.scores == two.scores;
      scored = scored || std::ranges::any_of(one.scores, [](double score) { return score != 0; });
    }
  }
  found.identical = found.identical && scored;
  return found;
}

std::optional<double> unseen_ln_ratio(const PairedAnswers& answers, std::span<const Trial> without,
                                      double set_delta_t_k, const PsychometricFit& fit, PsychometricForm form) {
  if (!fit.threshold || !fit.slope || answers.differing >= answers.count) return std::nullopt;
  constexpr double step = 1e-3;  // of ln size
  double derivatives = 0, trials = 0;
  const auto psi = [&](double size) { return psychometric(form, size, *fit.threshold, *fit.slope, fit.lapse); };
  for (const Trial& trial : without) {
    if (!same_contrast(trial.set_delta_t_k, set_delta_t_k) || !(trial.size_mrad > 0)) continue;
    derivatives += (psi(trial.size_mrad * std::exp(step)) - psi(trial.size_mrad * std::exp(-step))) / (2 * step);
    trials += 1;
  }
  const auto n = static_cast<double>(answers.count), k = static_cast<double>(answers.differing);
  const double share = boost::math::ibeta_inv(k + 1, n - k, 0.975) - k / n;
  constexpr double widest = 3;  // a factor of 20: the answers say nothing
  if (!(share * trials < widest * derivatives)) return std::nullopt;
  return share * trials / derivatives;
}

}  // namespace todbench
