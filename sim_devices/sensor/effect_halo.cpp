// SPDX-License-Identifier: GPL-3.0-or-later
// Halo: a share of the light that lens, window and detector scatter far round every point (size-of-source effect).
#include <cmath>
#include <numbers>

#include "sim_devices/sensor/effect_row.h"

namespace todbench {
namespace {

/// Sigmas after which nothing of a halo counts: exp(-12.5) of its middle.
constexpr double reach_sigmas = 5;

}  // namespace

EffectRow effect_rows::halo() {
  EffectRow row;
  row.title = "Halo";
  row.keys = {{"halo_share", &SensorSpec::halo_share, NumberRange::between(0, 0.5), KeyPresence::optional,
               "share of the light in a wide Gaussian round every point (size-of-source effect)"},
              {"halo_sigma_pitch", &SensorSpec::halo_sigma_pitch, NumberRange::between(0, 100), KeyPresence::optional,
               "sigma of that Gaussian per axis, in detector pitches"}};
  row.impossible = [](const SensorSpec& spec) -> std::string {
    return spec.halo_share > 0 && spec.halo_sigma_pitch == 0
               ? "halo_share needs halo_sigma_pitch: a share of the light without a width is no halo"
               : "";
  };
  row.is_neutral = [](const SensorSpec& spec, SceneMotion) {
    return spec.halo_share == 0 || spec.halo_sigma_pitch == 0;
  };
  row.neutralise = [](SensorSpec& spec) { spec.halo_share = 0; };
  row.neutral = "halo_share or halo_sigma_pitch is 0";
  row.stage = stage::Optics{[](const ChainScope& scope) -> std::function<double(double)> {
    return [share = scope.spec.halo_share, sigma = scope.spec.halo_sigma_pitch](double rho) {
      const double exponent = std::numbers::pi * sigma * rho;
      return 1 - share + share * std::exp(-2 * exponent * exponent);
    };
  }};
  // The halo is no blur of finite variance to the distant tails: it scatters its share of them, within the window.
  row.spread = [](const ChainScope& scope) {
    const double reach = reach_sigmas * scope.spec.halo_sigma_pitch;
    return Spread{.window = reach, .halo_share = scope.spec.halo_share, .halo_reach = reach};
  };
  // The halo takes its share of the contrast. Light that it returns to a triangle is of the right sign: no more is
  // lost.
  row.bound = [](const ExpectedScene& scene) -> std::optional<double> {
    return scene.discriminability_change(Effect::halo);
  };
  return row;
}

}  // namespace todbench
