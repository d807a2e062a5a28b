#include "sim_devices/sensor/effect_quantisation.h"

#include "sim_devices/sensor/effect_row.h"

namespace todbench {

EffectRow effect_rows::quantisation() {
  EffectRow row;
  row.title = "Quantisation";
  row.keys = {{"kelvin_per_count", &SensorSpec::kelvin_per_count, KeyRange::positive(), KeyPresence::optional,
               "linear temperature output: a step of one count"}};
  row.stage = stage::Counts{};
  row.white_variance_k2 = [](const SensorSpec& spec, double /*noise_factor*/) {
    return spec.kelvin_per_count * spec.kelvin_per_count / 12;
  };
  row.bound = [](const ExpectedScene& scene) -> std::optional<double> {
    return scene.noise_change(-scene.variance_of(Effect::quantisation));
  };
  return row;
}

}  // namespace todbench
