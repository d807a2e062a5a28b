// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/range/mrtd_formula.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace todbench {
namespace {

/// Second integral of a Gaussian density: max(x, 0) for a width of 0.
double ramp(double x, double sd) {
  if (sd <= 0) return std::max(x, 0.0);
  const double z = x / sd;
  return x * 0.5 * std::erfc(-z / std::numbers::sqrt2) + sd * std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi);
}

/// 2 p int_0^inf shared_density(n, v p) N(v)^2 sinc^2(v length) dv. sinc^2 is the transform of a triangle of half-width
/// `length`, N^2 that of a Gaussian of sqrt(2) sigma: the integral is p times the value of the triangle after the
/// Gaussian, at the distances at which samples share noise.
double spatial_share(double pitch_mrad, double length_mrad, double sigma_mrad, int alike) {
  const double sd = std::numbers::sqrt2 * sigma_mrad;
  double sum = 0;
  for (int k = 1 - alike; k < alike; ++k) {
    const double t = k * pitch_mrad;
    const double triangle = ramp(t + length_mrad, sd) - 2 * ramp(t, sd) + ramp(t - length_mrad, sd);
    sum += (1 - std::abs(k) / static_cast<double>(alike)) * triangle;
  }
  return pitch_mrad * sum / (length_mrad * length_mrad);
}

}  // namespace

double perceived_noise_k(const MrtdFormula& formula, double frequency_per_mrad, BarAxis axis) {
  const double width = 1 / (2 * frequency_per_mrad);
  const double e_t = 1 / (formula.frame_rate_hz * formula.eye_integration_s);
  const auto share = [&](double length, int alike) {
    return spatial_share(formula.pitch_mrad, length, formula.noise_filter_sigma_mrad, alike);
  };
  const double e_w = share(width, 1), e_l = share(7 * width, 1);
  const double fixed_w = share(width, formula.samples_per_detector),
               fixed_l = share(7 * width, formula.samples_per_detector);
  const NoiseRatios& n = formula.noise;
  const double along_t = axis == BarAxis::horizontal ? n.th : n.tv;
  const double fixed = axis == BarAxis::horizontal ? n.h : n.v;
  const double variance =
      e_t * e_w * e_l + n.vh * n.vh * fixed_w * fixed_l + along_t * along_t * e_t * e_w + fixed * fixed * e_w;
  return formula.snr_threshold * formula.netd_k * std::sqrt(variance);
}

double shared_density(int n, double cycles_per_sample) {
  double sum = 1;
  for (int k = 1; k < n; ++k)
    sum += 2 * (1 - static_cast<double>(k) / n) * std::cos(2 * std::numbers::pi * cycles_per_sample * k);
  return sum;
}

double mrtd_k(const MrtdFormula& formula, double frequency_per_mrad, double mtf, BarAxis axis) {
  constexpr double pi = std::numbers::pi;
  return pi * pi / 8 * perceived_noise_k(formula, frequency_per_mrad, axis) / mtf;
}

double mtdp_like_k(const MrtdFormula& formula, double frequency_per_mrad, double modulation, BarAxis axis) {
  return std::numbers::pi / 2 * perceived_noise_k(formula, frequency_per_mrad, axis) / modulation;
}

}  // namespace todbench
