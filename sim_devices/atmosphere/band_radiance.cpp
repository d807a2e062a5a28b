// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/atmosphere/band_radiance.h"

#include <fmt/format.h>

#include <cmath>

namespace todbench {
namespace {

// SI of 2019: exact h, c and k.
constexpr double planck = 6.62607015e-34, light = 299792458, boltzmann = 1.380649e-23;
constexpr double second_radiation_constant_um_k = 1e6 * planck * light / boltzmann;

double reduced(double wavelength_um, double temperature_k) {
  return second_radiation_constant_um_k / (wavelength_um * temperature_k);
}

/// int_x^inf t^3 / (e^t - 1) dt = sum_n e^(-n x) (x^3 / n + 3 x^2 / n^2 + 6 x / n^3 + 6 / n^4).
double tail(double x) {
  double sum = 0;
  for (int n = 1; n < 100000; ++n) {
    const double term = std::exp(-n * x) * (((x / n + 3.0 / n / n) * x + 6.0 / n / n / n) * x + 6.0 / n / n / n / n);
    sum += term;
    if (term <= 1e-17 * sum) break;
  }
  return sum;
}

/// 2 k^4 T^4 / (h^3 c^2), in W/(m2 sr).
double scale(double temperature_k) {
  const double kt = boltzmann * temperature_k / planck;
  return 2 * kt * kt * kt * boltzmann * temperature_k / (light * light);
}

/// t^4 / (e^t - 1).
double edge(double t) {
  return t * t * t * t / std::expm1(t);
}

}  // namespace

Result<void> validate(const SpectralBand& band) {
  if (std::isfinite(band.high_um) && band.low_um > 0 && band.high_um > band.low_um) return {};
  return fail(ErrorCode::invalid_input,
              fmt::format("the band from {:g} to {:g} um is empty: it needs 0 < low end < high end", band.low_um,
                          band.high_um));
}

double band_radiance(const SpectralBand& band, double temperature_k) {
  return scale(temperature_k) *
         (tail(reduced(band.high_um, temperature_k)) - tail(reduced(band.low_um, temperature_k)));
}

double band_radiance_derivative(const SpectralBand& band, double temperature_k) {
  const double x_low = reduced(band.low_um, temperature_k), x_high = reduced(band.high_um, temperature_k);
  // d(T^4 G(x)) / dT with x ~ 1 / T: T^3 (4 G + x^4 / (e^x - 1)).
  return scale(temperature_k) / temperature_k * (4 * (tail(x_high) - tail(x_low)) + edge(x_high) - edge(x_low));
}

std::optional<double> radiation_temperature_k(const SpectralBand& band, double radiance_w_m2_sr) {
  constexpr double hottest_k = 1e6;
  if (!(radiance_w_m2_sr > 0) || radiance_w_m2_sr > band_radiance(band, hottest_k)) return std::nullopt;
  double low = 1e-3, high = hottest_k;
  double t = 300;
  // ln B is nearly linear in 1 / T: Newton's method in these variables, kept inside the bracket.
  for (int i = 0; i < 200; ++i) {
    const double radiance = band_radiance(band, t);
    (radiance < radiance_w_m2_sr ? low : high) = t;
    if (radiance == radiance_w_m2_sr) return t;
    double next = 0;
    if (radiance > 0) {
      const double slope = -band_radiance_derivative(band, t) * t * t / radiance;  // d ln B / d(1 / T)
      next = 1 / (1 / t + std::log(radiance_w_m2_sr / radiance) / slope);
    }
    if (!(next > low && next < high)) next = std::sqrt(low) * std::sqrt(high);
    if (std::abs(next - t) <= 1e-15 * t || next == t) return next;
    t = next;
  }
  return t;
}

double thermal_weight(double wavelength_um, double temperature_k) {
  const double x = reduced(wavelength_um, temperature_k);
  const double denominator = std::expm1(-x);
  return std::pow(wavelength_um, -6) * std::exp(-x) / (denominator * denominator);
}

}  // namespace todbench
