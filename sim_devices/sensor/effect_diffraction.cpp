// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/effect_diffraction.h"

#include <cmath>
#include <numbers>

#include "hvs/shape/gauss_legendre.h"
#include "sim_devices/sensor/effect_row.h"

namespace todbench {
namespace {

constexpr double widest_spot_pitches = 100;  // lambda N; images of wider spots exceed the memory

constexpr double second_radiation_constant_um_k = 14387.768775;  // hc/k, exact in SI 2019, to 10 digits

/// dL/dT of a black body by wavelength, up to a factor: lambda^-6 e^x / (e^x - 1)^2, x = c2 / (lambda T).
double planck_derivative(double wavelength_um, double temperature_k) {
  const double x = second_radiation_constant_um_k / (wavelength_um * temperature_k);
  const double e = std::exp(-x);
  const double denominator = std::expm1(-x);
  return std::pow(wavelength_um, -6) * e / (denominator * denominator);
}

/// Averaged over the band, or at its mean wavelength if the plan skips the spectral band.
std::function<double(double)> factor(const ChainScope& scope) {
  const int count = scope.plan.simulates(Effect::spectral_band) ? scope.wavelengths : 1;
  return [nodes = wavelength_nodes(scope.spec, count), f_number = scope.spec.f_number,
          pitch_um = scope.spec.pitch_um](double rho) {
    double value = 0;
    for (const auto& node : nodes) value += node.weight * diffraction_mtf(rho, node.wavelength_um, f_number, pitch_um);
    return value;
  };
}

}  // namespace

double diffraction_mtf(double rho_per_pitch, double wavelength_um, double f_number, double pitch_um) {
  const double x = std::abs(rho_per_pitch) * wavelength_um * f_number / pitch_um;
  if (x >= 1) return 0;
  return 2 / std::numbers::pi * (std::acos(x) - x * std::sqrt(1 - x * x));
}

std::vector<WavelengthNode> wavelength_nodes(const SensorSpec& spec, int count) {
  const double middle = (spec.wavelength_min_um + spec.wavelength_max_um) / 2;
  const double half = (spec.wavelength_max_um - spec.wavelength_min_um) / 2;
  std::vector<WavelengthNode> nodes;
  double sum = 0;
  for (const auto& [x, weight] : gauss_legendre(count == 1 ? 16 : count)) {
    const double wavelength = middle + half * x;
    nodes.push_back({wavelength, weight * planck_derivative(wavelength, spec.scene_temperature_k)});
    sum += nodes.back().weight;
  }
  double mean = 0;
  for (auto& node : nodes) {
    node.weight /= sum;
    mean += node.weight * node.wavelength_um;
  }
  if (count == 1) return {{mean, 1.0}};
  return nodes;
}

EffectRow effect_rows::diffraction() {
  EffectRow row;
  row.title = "Diffraction";
  row.keys = {{"f_number", &SensorSpec::f_number, NumberRange::between(0.3, 100), KeyPresence::required,
               "focal length over aperture"}};
  row.impossible = [](const SensorSpec& spec) -> std::string {
    const double spot = spec.wavelength_max_um * spec.f_number / spec.pitch_um;
    return spot <= widest_spot_pitches ? ""
                                       : "wavelength_max_um times f_number, the width of the diffraction blur, is more "
                                         "than 100 pitches, the maximum";
  };
  row.stage = stage::Optics{factor};
  row.band = [](const SensorSpec& spec, const Accuracy&) {
    return spec.pitch_um / (spec.wavelength_min_um * spec.f_number);
  };
  // An upper bound for an undersampled sensor, within 0.02 of the change for a more finely sampled one.
  row.bound = [](const ExpectedScene& scene) -> std::optional<double> {
    return scene.discriminability_change(Effect::diffraction) + (scene.spec.samples_per_pitch() > 1 ? 0.02 : 0);
  };
  row.always = "simulated: it limits the frequencies, so skipping it would cost more time than it saves";
  row.when_bounded = WhenBounded::simulated;
  return row;
}

}  // namespace todbench
