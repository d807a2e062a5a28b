// SPDX-License-Identifier: GPL-3.0-or-later
// Gaussian blur of the lens beyond diffraction.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "sim_devices/sensor/effect_row.h"

namespace todbench {

EffectRow effect_rows::aberration() {
  EffectRow row;
  row.title = "Lens aberration";
  row.keys = {{"aberration_sigma_pitch", &SensorSpec::aberration_sigma_pitch, NumberRange::between(0, 10),
               KeyPresence::optional, "sigma of the Gaussian blur per axis, in detector pitches"}};
  row.is_neutral = [](const SensorSpec& spec, SceneMotion) { return spec.aberration_sigma_pitch == 0; };
  row.neutralise = [](SensorSpec& spec) { spec.aberration_sigma_pitch = 0; };
  row.neutral = "aberration_sigma_pitch is 0";
  row.stage = stage::Optics{[](const ChainScope& scope) -> std::function<double(double)> {
    return [sigma = scope.spec.aberration_sigma_pitch](double rho) {
      const double exponent = std::numbers::pi * sigma * rho;
      return std::exp(-2 * exponent * exponent);
    };
  }};
  row.spread = [](const ChainScope& scope) {
    const double sigma = scope.spec.aberration_sigma_pitch;
    return Spread{.period = 0, .window = 8 * sigma, .variance = sigma * sigma};
  };
  // Frequency at which the blur has reduced the signal to the tolerance.
  row.band = [](const SensorSpec& spec, const Accuracy& accuracy) {
    const double sigma = spec.aberration_sigma_pitch;
    if (sigma == 0) return std::numeric_limits<double>::infinity();
    return std::max(std::sqrt(-std::log(accuracy.band_tolerance) / 2) / (std::numbers::pi * sigma), 0.5);
  };
  row.bound = [](const ExpectedScene& scene) -> std::optional<double> {
    const double sigma = scene.spec.aberration_sigma_pitch;
    return 12 * sigma * sigma / (scene.s75_pitch * scene.s75_pitch);
  };
  return row;
}

}  // namespace todbench
