// SPDX-License-Identifier: GPL-3.0-or-later
// Mean of several exposures (SensorSpec::exposures_per_sample). It reduces temporal and line noise, not fixed pattern.
#include "sim_devices/sensor/effect_row.h"

namespace todbench {

EffectRow effect_rows::frame_averaging() {
  EffectRow row;
  row.title = "Frame averaging";
  row.keys = {{"frames_averaged", &SensorSpec::frames_averaged, NumberRange::between(1, 1024), KeyPresence::optional,
               "exposures averaged into one frame"}};
  row.is_neutral = [](const SensorSpec& spec, SceneMotion) { return spec.frames_averaged == 1; };
  row.neutralise = [](SensorSpec& spec) { spec.frames_averaged = 1; };
  row.neutral = "frames_averaged is 1";
  row.stage = stage::Parameter{};
  // The noise is larger without the effect, so the sign of the bound is reversed.
  row.bound = [](const ExpectedScene& scene) -> std::optional<double> {
    double averaged = 0;
    for (const Effect effect : all_effects) {
      const auto* noise = std::get_if<stage::Noise>(&row_of(effect).stage);
      if (noise != nullptr && noise->recurrence == stage::Recurrence::every_exposure)
        averaged += scene.variance_of(effect);
    }
    return scene.noise_change((scene.spec.frames_averaged - 1) * averaged);
  };
  return row;
}

}  // namespace todbench
