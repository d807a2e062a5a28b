#include "tod/range/mrtd_formula.h"

#include <cmath>
#include <numbers>

namespace todbench {
namespace {

/// 2 p int_0^inf N(v)^2 sinc^2(v length) dv. sinc^2 is the transform of a triangle of half-width `length`, N^2 that of
/// a Gaussian of sqrt(2) sigma: the integral is the triangle's mean under the Gaussian.
double spatial_share(double pitch_mrad, double length_mrad, double sigma_mrad) {
  if (sigma_mrad <= 0) return pitch_mrad / length_mrad;
  const double z = length_mrad / (2 * sigma_mrad);  // length over sqrt(2) times the Gaussian's sd
  const double inside = std::erf(z) + std::expm1(-z * z) / (z * std::sqrt(std::numbers::pi));
  return pitch_mrad / length_mrad * inside;
}

}  // namespace

double perceived_noise_k(const MrtdFormula& formula, double frequency_per_mrad, BarAxis axis) {
  const double width = 1 / (2 * frequency_per_mrad);
  const double e_t = 1 / (formula.frame_rate_hz * formula.eye_integration_s);
  const double e_w = spatial_share(formula.pitch_mrad, width, formula.noise_filter_sigma_mrad);
  const double e_l = spatial_share(formula.pitch_mrad, 7 * width, formula.noise_filter_sigma_mrad);
  const NoiseRatios& n = formula.noise;
  const double along_t = axis == BarAxis::horizontal ? n.th : n.tv;
  const double fixed = axis == BarAxis::horizontal ? n.h : n.v;
  const double variance =
      e_t * e_w * e_l + n.vh * n.vh * e_w * e_l + along_t * along_t * e_t * e_w + fixed * fixed * e_w;
  return formula.snr_threshold * formula.netd_k * std::sqrt(variance);
}

double mrtd_k(const MrtdFormula& formula, double frequency_per_mrad, double mtf, BarAxis axis) {
  constexpr double pi = std::numbers::pi;
  return pi * pi / 8 * perceived_noise_k(formula, frequency_per_mrad, axis) / mtf;
}

double mtdp_like_k(const MrtdFormula& formula, double frequency_per_mrad, double modulation, BarAxis axis) {
  return std::numbers::pi / 2 * perceived_noise_k(formula, frequency_per_mrad, axis) / modulation;
}

}  // namespace todbench
