// The array displaced n x n times per picture.
#include "sim_devices/sensor/effect_row.h"

namespace todbench {

EffectRow effect_rows::microscan() {
  EffectRow row;
  row.title = "Microscan";
  row.keys = {{"microscan", &SensorSpec::microscan, NumberRange::between(1, 4), KeyPresence::optional,
               "samples per detector pitch and axis: the array is displaced so often squared for a picture"}};
  row.is_neutral = [](const SensorSpec& spec, SceneMotion) { return spec.microscan == 1; };
  row.neutralise = [](SensorSpec& spec) { spec.microscan = 1; };
  row.neutral = "microscan is 1";
  row.stage = stage::Parameter{};
  row.always = "always simulated: it changes the sampling, for which there is no criterion";
  return row;
}

}  // namespace todbench
