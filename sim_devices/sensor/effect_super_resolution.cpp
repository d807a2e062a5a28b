// SPDX-License-Identifier: GPL-3.0-or-later
// Super-resolution: a grid twice as fine, from exposures displaced by half a pitch (SensorSpec::samples_per_pitch).
#include "sim_devices/sensor/effect_row.h"

namespace todbench {

EffectRow effect_rows::super_resolution() {
  EffectRow row;
  row.title = "Dynamic super-resolution";
  row.keys = {{"super_resolution_frames", &SensorSpec::super_resolution_frames, NumberRange::between(0, 1024),
               KeyPresence::optional,
               "exposures, displaced by half a pitch, on a grid twice as fine; a multiple of 4"}};
  row.impossible = [](const SensorSpec& spec) -> std::string {
    if (spec.super_resolution_frames % 4 != 0) return "super_resolution_frames must be 0 or a multiple of 4 up to 1024";
    if (spec.super_resolution_frames > 0 && spec.microscan > 1)
      return "super_resolution_frames and microscan exclude each other";
    return "";
  };
  row.is_neutral = [](const SensorSpec& spec, SceneMotion) { return spec.super_resolution_frames == 0; };
  row.neutralise = [](SensorSpec& spec) { spec.super_resolution_frames = 0; };
  row.neutral = "super_resolution_frames is 0";
  row.stage = stage::Parameter{};
  row.always = "always simulated: it changes the sampling, and no criterion covers this";
  return row;
}

}  // namespace todbench
