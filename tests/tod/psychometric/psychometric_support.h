// SPDX-License-Identifier: GPL-3.0-or-later
// Shared by the tests of the statistics: reference cases, simulated observers, and a likelihood written a second time.
#pragma once

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "acquisition/base/rng.h"
#include "tests/support/source_file.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench::testing {

inline nlohmann::json reference_cases() {
  std::ifstream file(source_file("tests/golden/psychometric_cases.json"));
  return nlohmann::json::parse(file);
}

/// Numbers are numbers or the texts "nan" and "inf".
inline double number(const nlohmann::json& value) {
  return value.is_string() ? std::stod(value.get<std::string>()) : value.get<double>();
}

inline std::vector<Level> levels_of(const nlohmann::json& one) {
  std::vector<Level> levels;
  for (std::size_t i = 0; i < one["levels"].size(); ++i)
    levels.push_back({number(one["levels"][i]), number(one["n_correct"][i]), number(one["n_total"][i]), -1});
  return levels;
}

inline std::vector<Level> levels_of_case(const nlohmann::json& reference, const std::string& id) {
  for (const auto& one : reference["cases"])
    if (one["id"] == id) return levels_of(one);
  return {};
}

/// `count` sizes in geometric progression from `first` to `last`.
inline std::vector<double> geometric(double first, double last, int count) {
  std::vector<double> sizes;
  for (int i = 0; i < count; ++i) sizes.push_back(first * std::pow(last / first, static_cast<double>(i) / (count - 1)));
  return sizes;
}

/// Number of right answers of `total` independent trials.
inline double binomial_draw(double probability, int total, const RandomStream& stream) {
  int right = 0;
  for (int i = 0; i < total; ++i) right += stream.uniform(static_cast<std::uint64_t>(i)) < probability ? 1 : 0;
  return right;
}

/// The ln likelihood straight from the definition, in long double, without the branches of the product.
inline double plain_log_likelihood(const std::vector<Level>& levels, PsychometricForm form, double ln_threshold,
                                   double slope, double lapse) {
  const long double g = 0.25L, a = 1 - g - static_cast<long double>(lapse);
  const bool size = form == PsychometricForm::size;
  const long double kappa = size ? std::log(a / (0.25L - static_cast<long double>(lapse))) : std::log(a / 0.5L);
  long double sum = 0;
  for (const Level& level : levels) {
    if (level.total == 0) continue;
    const long double u =
        static_cast<long double>(slope) * (std::log(static_cast<long double>(level.size)) - ln_threshold);
    const long double z = kappa * std::exp(size ? u : -u);
    const long double h = size ? -std::expm1(-z) : std::exp(-z);
    const long double rest = size ? std::exp(-z) : -std::expm1(-z);
    const long double psi = level.size > 0 ? g + a * h : g;
    const long double complement = level.size > 0 ? static_cast<long double>(lapse) + a * rest : 1 - g;
    if (level.correct > 0) sum += static_cast<long double>(level.correct) * std::log(psi);
    if (level.correct < level.total)
      sum += static_cast<long double>(level.total - level.correct) * std::log(complement);
  }
  return static_cast<double>(sum);
}

/// Highest plain likelihood over the slope at a fixed threshold: a dense scan of ln slope, then golden sections round
/// its best node.
inline double plain_profile(const std::vector<Level>& levels, PsychometricForm form, double ln_threshold,
                            double lapse) {
  const double first = std::log(0.1), last = std::log(50.0);
  constexpr int nodes = 240;
  const auto value = [&](double q) { return plain_log_likelihood(levels, form, ln_threshold, std::exp(q), lapse); };
  int best = 0;
  double highest = -INFINITY;
  for (int i = 0; i <= nodes; ++i) {
    const double v = value(first + (last - first) * i / nodes);
    if (v > highest) {
      highest = v;
      best = i;
    }
  }
  double low = first + (last - first) * std::max(best - 1, 0) / nodes;
  double high = first + (last - first) * std::min(best + 1, nodes) / nodes;
  const double ratio = (std::sqrt(5.0) - 1) / 2;
  for (int k = 0; k < 60; ++k) {
    const double x = high - ratio * (high - low), y = low + ratio * (high - low);
    (value(x) < value(y) ? low : high) = value(x) < value(y) ? x : y;
  }
  return std::max(highest, value((low + high) / 2));
}

}  // namespace todbench::testing
