// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/effect_quantisation.h"

#include <numbers>

#include "sim_devices/sensor/effect_display.h"
#include "sim_devices/sensor/effect_row.h"

namespace todbench {

double noise_in_counts(const SensorSpec& spec) {
  double variance = 0;
  for (const Effect effect : all_effects) {
    const EffectRow& row = row_of(effect);
    if (row.white_variance_k2 != nullptr && effect != Effect::quantisation) variance += row.white_variance_k2(spec, 1);
  }
  return std::sqrt(variance) * display_noise_gain(spec) / spec.kelvin_per_count;
}

bool rounds_coarsely(const SensorSpec& spec) {
  return noise_in_counts(spec) < 1;
}

bool reaches_an_end(const SensorSpec& spec, double delta_t_k, double background_k) {
  const double surround = (background_k - spec.offset_k) / spec.kelvin_per_count;
  const double target = surround + delta_t_k / spec.kelvin_per_count;
  const double spread = 6 * std::hypot(noise_in_counts(spec), spec.fixed_pattern_k / spec.kelvin_per_count);
  const double full_scale = std::exp2(spec.bits) - 1;
  return std::min(surround, target) - spread < 0 || std::max(surround, target) + spread > full_scale;
}

Quantiser::Reading Quantiser::reading(double kelvin, double sd_k) const {
  const double centre = background_ + kelvin * per_kelvin_;
  const double sd = sd_k * per_kelvin_;
  const double low = std::floor(centre - 8 * sd), high = std::ceil(centre + 8 * sd);
  const auto below = [&](double limit) {
    return sd > 0 ? 0.5 * std::erfc((centre - limit) / (sd * std::numbers::sqrt2)) : (limit > centre ? 1.0 : 0.0);
  };
  double mean = 0, square = 0;
  for (double count = low; count <= high; ++count) {
    const double share = (count == high ? 1 : below(count + 0.5)) - (count == low ? 0 : below(count - 0.5));
    const double from_surround = std::clamp(count, 0.0, std::floor(full_scale_)) - background_;
    mean += share * from_surround;
    square += share * from_surround * from_surround;
  }
  return {mean * step_k_, std::sqrt(std::max(0.0, square - mean * mean)) * step_k_};
}

EffectRow effect_rows::quantisation() {
  EffectRow row;
  row.title = "Quantisation";
  row.keys = {{"kelvin_per_count", &SensorSpec::kelvin_per_count, NumberRange::between(1e-6, 1000),
               KeyPresence::optional, "linear temperature output: step of one count"}};
  row.stage = stage::Counts{};
  row.white_variance_k2 = [](const SensorSpec& spec, double /*noise_factor*/) {
    return spec.kelvin_per_count * spec.kelvin_per_count / 12;
  };
  row.bound = [](const ExpectedScene& scene) -> std::optional<double> {
    if (rounds_coarsely(scene.spec)) return std::nullopt;
    return scene.noise_change(-scene.variance_of(Effect::quantisation));
  };
  row.always =
      "simulated: a count is larger than the noise, so rounding depends on the signal and no criterion applies";
  return row;
}

}  // namespace todbench
