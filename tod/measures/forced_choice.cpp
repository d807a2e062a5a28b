// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/forced_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "acquisition/base/distributions.h"

namespace todbench {
namespace {

constexpr double z75 = 0.6744897501960817;
constexpr double least_exponent = 0.5, most_exponent = 6;
constexpr std::array<double, 4> lapses{0.0, 0.02, 0.04, 0.06};
/// Twice the log-likelihood ratio against guessing of a fit with two more free parameters that chance exceeds in 0.1 %.
constexpr double least_ratio = 13.82;

/// Answers at one contrast of one polarity.
struct ChoiceCell {
  double ln_contrast = 0;
  int shown = 0, right = 0;
};
using Cells = std::vector<ChoiceCell>;

Cells cells_of(std::span<const ForcedChoice> answers, double sign, std::optional<int> without) {
  std::map<double, ChoiceCell> cells;
  for (const ForcedChoice& one : answers) {
    if (!(sign * one.contrast_k > 0) || one.set_up == without) continue;
    ChoiceCell& cell = cells[std::log(std::abs(one.contrast_k))];
    ++cell.shown, cell.right += one.right ? 1 : 0;
  }
  Cells out;
  for (auto& [ln_contrast, cell] : cells) {
    cell.ln_contrast = ln_contrast;
    out.push_back(cell);
  }
  return out;
}

double share_at(double u, double exponent, double lapse) {
  const double seen = 0.5 * std::erfc(-z75 * std::exp(exponent * u) / std::numbers::sqrt2);
  return 0.5 * lapse + (1 - lapse) * seen;
}

double log_likelihood(const Cells& cells, double ln_threshold, double exponent, double lapse) {
  double sum = 0;
  for (const ChoiceCell& cell : cells) {
    const double share = std::min(share_at(cell.ln_contrast - ln_threshold, exponent, lapse), 1 - 1e-12);
    sum += cell.right * std::log(share) + (cell.shown - cell.right) * std::log(1 - share);
  }
  return sum;
}

/// Information of independent answers about ln threshold, at a fixed exponent.
double information(const Cells& cells, double ln_threshold, double exponent, double lapse) {
  constexpr double step = 1e-4;
  double sum = 0;
  for (const ChoiceCell& cell : cells) {
    const double u = cell.ln_contrast - ln_threshold, share = share_at(u, exponent, lapse);
    const double slope = (share_at(u + step, exponent, lapse) - share_at(u - step, exponent, lapse)) / (2 * step);
    sum += cell.shown * slope * slope / std::max(share * (1 - share), 1e-9);
  }
  return sum;
}

/// Threshold of one polarity at a fixed exponent and lapse.
struct OnePolarity {
  double ln_threshold = 0, log_likelihood = -1e300;
};
/// `reach`: beyond the contrasts, in ln contrast, so that a threshold outside of them shows itself.
OnePolarity best_threshold(const Cells& cells, double exponent, double lapse) {
  constexpr double reach = 0.7, coarse = 0.08;
  constexpr int halvings = 5;
  OnePolarity best;
  const auto look = [&](double ln_threshold) {
    const double found = log_likelihood(cells, ln_threshold, exponent, lapse);
    if (found > best.log_likelihood) best = {ln_threshold, found};
  };
  const double last = cells.back().ln_contrast + reach;
  for (double at = cells.front().ln_contrast - reach; at <= last; at += coarse) look(at);
  for (double step = 0.5 * coarse, k = 0; k < halvings; step *= 0.5, ++k) {
    const double middle = best.ln_threshold;
    look(middle - step), look(middle + step);
  }
  return best;
}

/// Mean over exponents and lapses, weighted by the likelihood: a single best pair would jump with each answer.
struct BothPolarities {
  double ln_positive = 0, ln_negative = 0, lapse = 0;
  double variance = 0;        ///< of ln half_k, of independent answers
  double log_likelihood = 0;  ///< of the best pair

  [[nodiscard]] double half_k() const { return 0.5 * (std::exp(ln_positive) + std::exp(ln_negative)); }
};

/// Fit at one exponent and lapse.
struct FixedShape {
  OnePolarity positive, negative;
  double lapse = 0, variance = 0;

  [[nodiscard]] double half_k() const {
    return 0.5 * (std::exp(positive.ln_threshold) + std::exp(negative.ln_threshold));
  }
  [[nodiscard]] double log_likelihood() const { return positive.log_likelihood + negative.log_likelihood; }
};

FixedShape fixed_shape(const Cells& positive, const Cells& negative, double exponent, double lapse) {
  FixedShape out{best_threshold(positive, exponent, lapse), best_threshold(negative, exponent, lapse), lapse, 0};
  for (const auto& [cells, one] : {std::pair(&positive, &out.positive), std::pair(&negative, &out.negative)}) {
    const double share = 0.5 * std::exp(one->ln_threshold) / out.half_k();
    out.variance += share * share / std::max(information(*cells, one->ln_threshold, exponent, lapse), 1e-3);
  }
  return out;
}

BothPolarities fitted(const Cells& positive, const Cells& negative) {
  constexpr int exponents = 8;
  std::vector<FixedShape> shapes;
  for (const double lapse : lapses) {
    for (int k = 0; k <= exponents; ++k) {
      const double exponent = least_exponent * std::pow(most_exponent / least_exponent, 1.0 * k / exponents);
      shapes.push_back(fixed_shape(positive, negative, exponent, lapse));
    }
  }
  BothPolarities out;
  out.log_likelihood = std::ranges::max(shapes, {}, &FixedShape::log_likelihood).log_likelihood();
  double sum = 0, mean = 0, squares = 0;
  for (const FixedShape& one : shapes) {
    const double weight = std::exp(one.log_likelihood() - out.log_likelihood), ln_half = std::log(one.half_k());
    sum += weight;
    out.ln_positive += weight * one.positive.ln_threshold, out.ln_negative += weight * one.negative.ln_threshold;
    out.lapse += weight * one.lapse, out.variance += weight * one.variance;
    mean += weight * ln_half, squares += weight * ln_half * ln_half;
  }
  for (double* value : {&out.ln_positive, &out.ln_negative, &out.lapse, &out.variance, &mean, &squares}) *value /= sum;
  out.variance += std::max(0.0, squares - mean * mean);
  return out;
}

std::string outside(const Cells& cells, double ln_threshold, const char* polarity) {
  if (ln_threshold > cells.back().ln_contrast)
    return fmt::format("no {} contrast up to {:.3g} K reaches 75 % correct", polarity,
                       std::exp(cells.back().ln_contrast));
  if (ln_threshold < cells.front().ln_contrast)
    return fmt::format("the smallest {} contrast, {:.3g} K, is above the threshold", polarity,
                       std::exp(cells.front().ln_contrast));
  return {};
}

int shown_in(const Cells& cells) {
  int sum = 0;
  for (const ChoiceCell& cell : cells) sum += cell.shown;
  return sum;
}

}  // namespace

double jackknife_variance_of_ln(const std::map<int, double>& without) {
  const auto n = static_cast<double>(without.size());
  double mean = 0, squares = 0;
  for (const auto& [part, value] : without) mean += std::log(value) / n;
  for (const auto& [part, value] : without) squares += std::pow(std::log(value) - mean, 2);
  return squares * (n - 1) / n;
}

ForcedChoiceThreshold forced_choice_threshold(std::span<const ForcedChoice> answers) {
  ForcedChoiceThreshold out;
  out.answers = static_cast<int>(answers.size());
  out.right = static_cast<int>(std::ranges::count_if(answers, &ForcedChoice::right));
  std::set<int> set_ups;
  for (const ForcedChoice& one : answers) set_ups.insert(one.set_up);
  const Cells positive = cells_of(answers, 1, {}), negative = cells_of(answers, -1, {});
  const int fewest = std::min(shown_in(positive), shown_in(negative));
  if (fewest < least_choices || static_cast<int>(set_ups.size()) < least_choice_set_ups) {
    out.reason = fmt::format("{} answers at a polarity and {} set-ups; a threshold needs {} and {}", fewest,
                             set_ups.size(), least_choices, least_choice_set_ups);
    return out;
  }
  const BothPolarities all = fitted(positive, negative);
  out.lapse = all.lapse;
  const double guessing = -std::numbers::ln2 * static_cast<double>(answers.size());
  if (2 * (all.log_likelihood - guessing) < least_ratio) {
    out.reason = fmt::format("{} of {} answers are right, which does not differ from guessing", out.right, out.answers);
    return out;
  }
  out.reason = outside(positive, all.ln_positive, "positive");
  if (out.reason.empty()) out.reason = outside(negative, all.ln_negative, "negative");
  if (!out.reason.empty()) return out;
  out.positive_k = std::exp(all.ln_positive), out.negative_k = -std::exp(all.ln_negative);
  out.half_k = all.half_k();
  for (const int set_up : set_ups) {
    const Cells some = cells_of(answers, 1, set_up), others = cells_of(answers, -1, set_up);
    if (!some.empty() && !others.empty()) out.half_k_without[set_up] = fitted(some, others).half_k();
  }
  const auto n = static_cast<double>(out.half_k_without.size());
  const double variance = std::max(jackknife_variance_of_ln(out.half_k_without), all.variance);
  const double reach = quantile(distribution::StudentsT(n - 1), 0.975) * std::sqrt(variance);
  out.ci95 = {*out.half_k * std::exp(-reach), *out.half_k * std::exp(reach)};
  return out;
}

}  // namespace todbench
