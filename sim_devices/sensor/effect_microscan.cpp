// SPDX-License-Identifier: GPL-3.0-or-later
// Microscan: n x n displacements of the array per picture.
#include "sim_devices/sensor/effect_row.h"

namespace todbench {

EffectRow effect_rows::microscan() {
  EffectRow row;
  row.title = "Microscan";
  row.keys = {{"microscan", &SensorSpec::microscan, NumberRange::between(1, 4), KeyPresence::optional,
               "samples per detector pitch and axis; n: the array is displaced n x n times per picture"}};
  row.is_neutral = [](const SensorSpec& spec, SceneMotion) { return spec.microscan == 1; };
  row.neutralise = [](SensorSpec& spec) { spec.microscan = 1; };
  row.neutral = "microscan is 1";
  row.stage = stage::Parameter{};
  row.always = "always simulated: it changes the sampling, and no criterion covers this";
  return row;
}

}  // namespace todbench
