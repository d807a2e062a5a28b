// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/sensor_key.h"

#include "sim_devices/sensor/effect_row.h"

namespace todbench {
const std::vector<SensorKey>& camera_keys() {
  using enum KeyPresence;
  static const std::vector<SensorKey> keys{
      {"width", &SensorSpec::width, NumberRange::between(16, 16384), required, "detectors per row"},
      {"height", &SensorSpec::height, NumberRange::between(16, 16384), required, "rows of detectors"},
      {"pitch_um", &SensorSpec::pitch_um, NumberRange::between(0.1, 1000), required, "distance of detector centres"},
      {"pitch_y_um", &SensorSpec::pitch_y_um, NumberRange::between(0, 1000), optional,
       "distance of detector centres along the columns, if it differs; 0: pitch_um"},
      {"focal_length_mm", &SensorSpec::focal_length_mm, NumberRange::between(0.5, 1e4), required, "focal length"},
      {"optics_transmission",
       &SensorSpec::optics_transmission,
       {.low = 0, .high = 1, .low_edge = NumberRange::Edge::excluded},
       optional,
       "transmission of the lens; NETD is referred to the scene and already contains it"},
      {"bits", &SensorSpec::bits, NumberRange::between(8, 16), optional, "significant bits of a count"},
      {"offset_k", &SensorSpec::offset_k, NumberRange::between(-1e4, 1e5), optional, "temperature of count 0"},
      {"frame_rate_hz", &SensorSpec::frame_rate_hz, NumberRange::between(1e-3, 1e5), optional, "frames per second"},
      {"scene_temperature_k", &SensorSpec::scene_temperature_k, NumberRange::between(150, 5000), optional,
       "temperature of the surround; weights the wavelengths"},
      {"defective_pixel_share", &SensorSpec::defective_pixel_share, NumberRange::between(0, 0.1), optional,
       "share of detectors that are stuck, hot, noisy or blinking; frames show them, estimates without frames omit "
       "them"},
      {"defect_seed", &SensorSpec::defect_seed, NumberRange::between(0, 1000000000), optional,
       "determines which detectors are defective, and how; belongs to the array, not to the run"},
  };
  return keys;
}

std::vector<SensorKey> sensor_keys() {
  std::vector<SensorKey> keys = camera_keys();
  for (const Effect effect : all_effects) {
    const auto& own = row_of(effect).keys;
    keys.insert(keys.end(), own.begin(), own.end());
  }
  return keys;
}

}  // namespace todbench
