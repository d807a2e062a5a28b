// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/effect_turbulence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "sim_devices/sensor/effect_diffraction.h"
#include "sim_devices/sensor/effect_image_dance.h"
#include "sim_devices/sensor/effect_row.h"

namespace todbench {
namespace {

constexpr double widest_turbulence_pitch = 10;

/// Sigma of the Gaussian blur that equals the long exposure at its fall to 1 / e.
double turbulence_sigma_pitch(const SensorSpec& spec) {
  return std::pow(turbulence_strength(spec), 0.6) / (std::numbers::pi * std::numbers::sqrt2);
}

}  // namespace

std::optional<TurbulentPath> turbulent_path(const SensorSpec& spec) {
  if (spec.turbulence_cn2_m_minus_2_3 == 0 || spec.turbulence_path_m == 0) return std::nullopt;
  return TurbulentPath{.cn2_m_minus_2_3 = spec.turbulence_cn2_m_minus_2_3,
                       .path_m = spec.turbulence_path_m,
                       .wavelength_um = wavelength_nodes(spec, 1).front().wavelength_um};
}

double turbulence_strength(const SensorSpec& spec) {
  const auto path = turbulent_path(spec);
  return path ? long_exposure_exponent(*path, 1 / spec.ifov_mrad()) : 0;
}

double turbulence_bound(const SensorSpec& spec, double s75_pitch) {
  // exp(-c rho^(5/3)) = exp(-2 pi^2 sigma^2 rho^2) at rho = 1 / (2 S); above it sigma is smaller.
  const double variance =
      turbulence_strength(spec) * std::cbrt(2 * s75_pitch) / (2 * std::numbers::pi * std::numbers::pi);
  return 12 * variance / (s75_pitch * s75_pitch);
}

EffectRow effect_rows::turbulence() {
  EffectRow row;
  row.title = "Atmospheric turbulence";
  row.keys = {{"turbulence_cn2_m_minus_2_3", &SensorSpec::turbulence_cn2_m_minus_2_3, NumberRange::between(0, 1e-11),
               KeyPresence::optional, "structure parameter Cn2 along the path; 0: no turbulence"},
              {"turbulence_path_m", &SensorSpec::turbulence_path_m, NumberRange::between(0, 1e5), KeyPresence::optional,
               "length of the turbulent path"}};
  row.impossible = [](const SensorSpec& spec) -> std::string {
    if (!(spec.ifov_mrad() > 0) || !(spec.wavelength_max_um > spec.wavelength_min_um) ||
        turbulence_sigma_pitch(spec) <= widest_turbulence_pitch)
      return {};
    return "turbulence_cn2_m_minus_2_3 and turbulence_path_m blur by more than 10 pitches, the maximum";
  };
  row.is_neutral = [](const SensorSpec& spec, SceneMotion) {
    return spec.turbulence_cn2_m_minus_2_3 == 0 || spec.turbulence_path_m == 0;
  };
  row.neutralise = [](SensorSpec& spec) { spec.turbulence_cn2_m_minus_2_3 = 0; };
  row.neutral = "turbulence_cn2_m_minus_2_3 or turbulence_path_m is 0";
  row.stage = stage::Optics{[](const ChainScope& scope) -> std::function<double(double)> {
    const double strength = turbulence_strength(scope.spec);
    // Exposure and time constant average the dance; if their effects are skipped, the dance is instantaneous.
    const double left_out = dance_weight(scope.spec) * dance_share(as_planned(scope.spec, scope.plan));
    if (left_out == 0) return [strength](double rho) { return std::exp(-strength * std::pow(rho, 5.0 / 3)); };
    // Fried's short exposure. Beyond the cut-off of the lens, which no wavelength of the mean passes, it is constant.
    return [strength, left_out, cut_off = dance_cut_off(scope.spec)](double rho) {
      const double f = std::min(rho, cut_off);
      return std::exp(-strength * std::pow(f, 5.0 / 3) * (1 - left_out * std::cbrt(f / cut_off)));
    };
  }};
  // The tail of -c rho^(5/3) is c pi^(-8/3) Gamma(11/6) / -Gamma(-5/6) r^(-11/3) = 0.00665 c r^(-11/3). It falls faster
  // than that of diffraction. The plane beyond r adds 0.0251 c r^(-5/3).
  row.spread = [](const ChainScope& scope) {
    const double sigma = turbulence_sigma_pitch(scope.spec);
    return Spread{.period = 8 * sigma,
                  .window = 16 * sigma,
                  .variance = sigma * sigma,
                  .far = 0.0251 * turbulence_strength(scope.spec)};
  };
  row.band = [](const SensorSpec& spec, const Accuracy& accuracy) {
    const double strength = turbulence_strength(spec);
    // Short frames may contain frequencies that the long exposure suppresses.
    if (strength == 0 || spec.turbulence_correlation_ms > 0) return std::numeric_limits<double>::infinity();
    return std::max(std::pow(-std::log(accuracy.band_tolerance) / strength, 0.6), 0.5);
  };
  row.bound = [](const ExpectedScene& scene) -> std::optional<double> {
    return turbulence_bound(scene.spec, scene.s75_pitch);
  };
  return row;
}

}  // namespace todbench
