// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/range/probability_forms.h"

#include <cassert>
#include <cmath>

namespace todbench {
namespace {

struct Exponent {
  double constant = 0, slope = 0;
};

Exponent exponent_of(ProbabilityForm form) {
  switch (form) {
    case ProbabilityForm::johnson:
      return {2.7, 0.7};
    case ProbabilityForm::ttp_2004:
      return {1.51, 0.24};
    case ProbabilityForm::fixed_1_5:
      return {1.5, 0};
  }
  return {};
}

/// ln(P / (1 - P)); it increases with x, as slope x |ln x| <= slope / e < E below x = 1.
double log_odds(ProbabilityForm form, double x) {
  const auto [constant, slope] = exponent_of(form);
  return (constant + slope * x) * std::log(x);
}

}  // namespace

std::string_view to_string(ProbabilityForm form) {
  switch (form) {
    case ProbabilityForm::johnson:
      return "johnson";
    case ProbabilityForm::ttp_2004:
      return "ttp-2004";
    case ProbabilityForm::fixed_1_5:
      return "fixed-1.5";
  }
  return "";
}

double target_probability(ProbabilityForm form, double x) {
  return x > 0 ? 1 / (1 + std::exp(-log_odds(form, x))) : 0;
}

double ratio_for_probability(ProbabilityForm form, double probability) {
  assert(probability > 0 && probability < 1);
  const double wanted = std::log(probability) - std::log1p(-probability);
  double low = 0, high = 1;
  while (log_odds(form, high) < wanted) high *= 2;
  for (int i = 0; i < 2000; ++i) {
    const double middle = low + (high - low) / 2;
    if (!(middle > low && middle < high)) break;
    (log_odds(form, middle) < wanted ? low : high) = middle;
  }
  return high;
}

}  // namespace todbench
