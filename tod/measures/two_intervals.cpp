// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/two_intervals.h"

#include <algorithm>
#include <array>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

#include "acquisition/base/normal.h"

namespace todbench {
namespace {

double probit(double p) {
  return std::numbers::sqrt2 * boost::math::erf_inv(2 * std::clamp(p, 1e-6, 1 - 1e-6) - 1);
}

constexpr std::size_t most_parameters = 4;
constexpr double least_energy = 0.02;  // of the mean: a threshold seven times the level

double energy_at(const ContrastFunction& function, double phase) {
  const double angle = 2 * std::numbers::pi * phase;
  return std::max(1 + function.swing[0] * std::cos(angle) + function.swing[1] * std::sin(angle), least_energy);
}

/// Share by a function, and its derivatives by ln level, exponent and swings.
struct FittedShare {
  double share = 0;
  std::array<double, most_parameters> slope{};
};
FittedShare fitted_share(const ContrastFunction& of, const ContrastShare& at) {
  const double z75 = probit(threshold_share);
  const double u = std::log(at.contrast_k / of.level_k) - of.ln_ratio_at(at.phase);
  const double z = z75 * std::exp(of.exponent * u);
  const double density = std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
  const double by_u = density * z * of.exponent, angle = 2 * std::numbers::pi * at.phase;
  const double by_energy = 0.5 * by_u / energy_at(of, at.phase);
  return {normal_probability(z), {-by_u, density * z * u, by_energy * std::cos(angle), by_energy * std::sin(angle)}};
}

/// Reduces the swing until the energy is positive at every phase.
void keep_positive(ContrastFunction& function) {
  const double most = std::hypot(function.swing[0], function.swing[1]);
  if (most <= 1 - least_energy) return;
  for (double& swing : function.swing) swing *= (1 - least_energy) / most;
}

}  // namespace

ShareOfPairs share_of_pairs(const IntervalScores& pattern, const IntervalScores& other) {
  const std::size_t draws = pattern.front().size();
  std::vector<float> all_pattern, all_other;
  for (const auto& row : pattern) all_pattern.insert(all_pattern.end(), row.begin(), row.end());
  for (const auto& row : other) all_other.insert(all_other.end(), row.begin(), row.end());
  std::sort(all_pattern.begin(), all_pattern.end());
  std::sort(all_other.begin(), all_other.end());
  const auto below = [](const std::vector<float>& sorted, float value) {
    const auto range = std::equal_range(sorted.begin(), sorted.end(), value);
    return static_cast<double>(range.first - sorted.begin()) + static_cast<double>(range.second - range.first) / 2;
  };
  const auto pairs = static_cast<double>(pattern.size() * other.size() * (draws - 1));
  ShareOfPairs out;
  double squares_pattern = 0, squares_other = 0, sum_other = 0;
  for (std::size_t d = 0; d < draws; ++d) {
    double own = 0, wins = 0, losses = 0;
    for (const auto& p : pattern) {
      wins += below(all_other, p[d]);
      for (const auto& o : other) own += p[d] > o[d] ? 1 : p[d] == o[d] ? 0.5 : 0;
    }
    for (const auto& o : other) losses += static_cast<double>(all_pattern.size()) - below(all_pattern, o[d]);
    const double by_pattern = (wins - own) / pairs, by_other = (losses - own) / pairs;
    out.mean += by_pattern;
    sum_other += by_other;
    squares_pattern += by_pattern * by_pattern;
    squares_other += by_other * by_other;
  }
  const auto n = static_cast<double>(draws);
  out.mean /= n;
  sum_other /= n;
  const double variance =
      (squares_pattern / n - out.mean * out.mean + squares_other / n - sum_other * sum_other) / (n - 1);
  out.standard_error = std::sqrt(std::max(0.0, variance));
  return out;
}

PassedContrast passed_contrast(std::span<const double> contrasts_k, std::span<const ShareOfPairs> shares) {
  for (std::size_t i = 1; i < shares.size(); ++i) {
    if (shares[i].mean < threshold_share || shares[i - 1].mean >= threshold_share) continue;
    const double low = probit(shares[i - 1].mean), high = probit(shares[i].mean);
    const double step = std::log(contrasts_k[i] / contrasts_k[i - 1]);
    const double place = (probit(threshold_share) - low) / (high - low);
    const double slope = (shares[i].mean - shares[i - 1].mean) / step;
    return {contrasts_k[i - 1] * std::exp(place * step), shares[i].standard_error / slope};
  }
  return {};
}

double ContrastFunction::ln_ratio_at(double phase) const {
  return -0.5 * std::log(energy_at(*this, phase));
}

double ContrastFunction::best_phase() const {
  return std::atan2(swing[1], swing[0]) / (2 * std::numbers::pi);
}

std::optional<ContrastFunction> fit_contrast(std::span<const ContrastShare> shares, double near_k, PhaseFit phases) {
  constexpr int rounds = 60;
  constexpr double least_exponent = 0.3, most_exponent = 8, largest_step = 0.3, least_variance = 0.02;
  const int parameters = phases == PhaseFit::swing ? 4 : 2;
  std::vector<ContrastShare> used;
  for (const ContrastShare& one : shares) {
    if (std::abs(std::log(one.contrast_k / near_k)) <= std::log(fitted_span)) used.push_back(one);
  }
  if (static_cast<int>(used.size()) < parameters) return std::nullopt;
  ContrastFunction found{.level_k = near_k, .exponent = 1.5, .swing = {}};
  for (int round = 0; round < rounds; ++round) {
    cv::Mat1d information = cv::Mat1d::eye(parameters, parameters) * 1e-9, score(parameters, 1, 0.0), step;
    for (const ContrastShare& one : used) {
      const FittedShare at = fitted_share(found, one);
      const double weight = 1 / std::max(at.share * (1 - at.share), least_variance);
      for (int i = 0; i < parameters; ++i) {
        const double slope = at.slope[static_cast<std::size_t>(i)];
        score(i) += weight * slope * (one.share - at.share);
        for (int k = 0; k < parameters; ++k)
          information(i, k) += weight * slope * at.slope[static_cast<std::size_t>(k)];
      }
    }
    if (!cv::solve(information, score, step, cv::DECOMP_CHOLESKY)) return std::nullopt;
    const double longest = cv::norm(step, cv::NORM_INF);
    if (longest > largest_step) step *= largest_step / longest;
    found.level_k *= std::exp(step(0));
    found.exponent = std::clamp(found.exponent + step(1), least_exponent, most_exponent);
    if (parameters == 4) {
      found.swing[0] += step(2), found.swing[1] += step(3);
      keep_positive(found);
    }
    if (longest < 1e-9) break;
  }
  if (!(std::abs(std::log(found.level_k / near_k)) <= std::log(fitted_span))) return std::nullopt;
  return found;
}

}  // namespace todbench
