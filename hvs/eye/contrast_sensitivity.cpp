// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/eye/contrast_sensitivity.h"

#include <fmt/format.h>
#include <array>
#include <cmath>
#include <map>
#include <mutex>
#include <numbers>
#include <utility>

#include "acquisition/base/normal.h"
#include "acquisition/base/number_range.h"
#include "hvs/eye/eye_optics.h"

namespace todbench {
namespace {

/// Proportion correct in 2AFC of the rule of the largest response: the interval with the pattern has one channel with
/// mean d' and M - 1 without, the other M without. By the trapezoidal rule, which converges exponentially here.
double largest_response_correct(double d_prime, double channels) {
  constexpr double step = 0.02, least = -9, most = 15;
  double sum = 0;
  for (double x = least; x < most; x += step) {
    const double below = std::log(normal_probability(x));
    // The largest of M channels is at x through the channel with the pattern, or through one of the others.
    const double with_pattern = normal_density(x - d_prime) * std::exp((channels - 1) * below);
    const double without =
        (channels - 1) * normal_density(x) * normal_probability(x - d_prime) * std::exp((channels - 2) * below);
    sum += (with_pattern + without) * std::exp(channels * below);
  }
  return sum * step;
}

/// Nodes and weights of Gauss-Hermite quadrature with seven points (Abramowitz and Stegun 25.10).
constexpr std::array<std::pair<double, double>, 7> hermite{{{-2.6519613568352335, 0.0009717812450995192},
                                                            {-1.6735516287674714, 0.05451558281912703},
                                                            {-0.8162878828589647, 0.4256072526101278},
                                                            {0, 0.8102646175568073},
                                                            {0.8162878828589647, 0.4256072526101278},
                                                            {1.6735516287674714, 0.05451558281912703},
                                                            {2.6519613568352335, 0.0009717812450995192}}};

}  // namespace

Result<void> validate(const EyeParameters& eye) {
  const std::pair<std::string_view, std::pair<double, NumberRange>> checked[] = {
      {"sensitivity", {eye.sensitivity, NumberRange::between(1, 1e9)}},
      {"photon_noise_td", {eye.photon_noise_td, NumberRange::between(0, 1e6)}},
      {"inhibition_per_degree", {eye.inhibition_per_degree, NumberRange::between(0.1, 100)}},
      {"critical_cycles", {eye.critical_cycles, NumberRange::between(0.1, 1000)}},
      {"area_exponent", {eye.area_exponent, NumberRange::between(0, 1)}},
      {"uncertainty_channels", {eye.uncertainty_channels, NumberRange::between(1, 1e6)}},
      {"contrast_noise", {eye.contrast_noise, NumberRange::between(0, 1)}},
      {"age_years", {eye.age_years, NumberRange::between(10, 90)}},
      {"field_deg2", {eye.field_deg2, NumberRange::between(0.01, 2e4)}}};
  for (const auto& [name, value] : checked) {
    if (!value.second.contains(value.first))
      return fail(ErrorCode::invalid_input,
                  fmt::format("{}: expected {}, found {:g}", name, value.second.describe(), value.first));
  }
  return {};
}

double detection_d_prime(double channels) {
  // A value takes milliseconds, few numbers of channels occur, and a filter is made for every decision about bars.
  static std::mutex mutex;
  static std::map<double, double> known;
  const std::scoped_lock lock(mutex);
  if (const auto found = known.find(channels); found != known.end()) return found->second;
  constexpr double correct = 0.84;
  double low = 0, high = 10;
  while (high - low > 1e-9) {
    const double middle = (low + high) / 2;
    (largest_response_correct(middle, channels) < correct ? low : high) = middle;
  }
  return known[channels] = (low + high) / 2;
}

EyeFilter::EyeFilter(const EyeParameters& eye, double luminance_cd_m2)
    : eye_(eye),
      pupil_mm_(pupil_diameter_mm(luminance_cd_m2, eye.field_deg2, eye.age_years)),
      illuminance_td_(retinal_illuminance_td(luminance_cd_m2, pupil_mm_)),
      identification_gain_(std::pow(detection_d_prime(eye.uncertainty_channels) / detection_d_prime(1), 2)) {}

double EyeFilter::detection_power(double frequency_per_degree) const {
  const double optics = eye_mtf(frequency_per_degree, pupil_mm_);
  // 1 / (E0 / E + 1 / passed), finite at frequency 0.
  const double passed = -std::expm1(-std::pow(frequency_per_degree / eye_.inhibition_per_degree, 2));
  return std::pow(eye_.sensitivity * optics, 2) * passed / (1 + passed * eye_.photon_noise_td / illuminance_td_);
}

double EyeFilter::gabor_d_prime(double frequency_per_degree, double sigma_deg) const {
  // The energy spectrum of the envelope is exp(-4 pi^2 sigma^2 nu^2).
  const double spread = 1 / (2 * std::numbers::pi * sigma_deg);
  double power = 0;
  for (const auto& [x, wx] : hermite) {
    for (const auto& [y, wy] : hermite)
      power += wx * wy / std::numbers::pi * detection_power(std::hypot(frequency_per_degree + spread * x, spread * y));
  }
  const double area = std::numbers::pi * sigma_deg * sigma_deg;
  const double critical = std::numbers::pi * std::pow(eye_.critical_cycles / frequency_per_degree, 2);
  const double effective = area / std::pow(1 + area / critical, 1 - eye_.area_exponent);
  return std::sqrt(power * effective / 2);
}

}  // namespace todbench
