#include "sim_devices/sensor/sensor_key.h"

#include <fmt/format.h>

#include <cmath>

#include "sim_devices/sensor/effect_row.h"

namespace todbench {
namespace {

std::string text_of(double value) {
  return fmt::format("{:g}", value);
}

}  // namespace

bool KeyRange::contains(double value) const {
  return std::isfinite(value) && value <= high && (low_edge == Edge::included ? value >= low : value > low);
}

std::string KeyRange::describe() const {
  const bool bounded_below = low > std::numeric_limits<double>::lowest();
  const bool bounded_above = high < std::numeric_limits<double>::max();
  const bool excluded = low_edge == Edge::excluded;
  if (!bounded_below) return bounded_above ? "at most " + text_of(high) : "a number";
  if (!bounded_above) return excluded ? "above " + text_of(low) : text_of(low) + " or more";
  return (excluded ? "above " + text_of(low) + " and at most " : "from " + text_of(low) + " to ") + text_of(high);
}

const std::vector<SensorKey>& camera_keys() {
  using enum KeyPresence;
  static const std::vector<SensorKey> keys{
      {"width", &SensorSpec::width, KeyRange::between(16, 16384), required, "detectors in a row"},
      {"height", &SensorSpec::height, KeyRange::between(16, 16384), required, "rows of detectors"},
      {"pitch_um", &SensorSpec::pitch_um, KeyRange::positive(), required, "detectors, centre to centre"},
      {"focal_length_mm", &SensorSpec::focal_length_mm, KeyRange::positive(), required, "focal length"},
      {"optics_transmission",
       &SensorSpec::optics_transmission,
       {.low = 0, .high = 1, .low_edge = KeyRange::Edge::excluded},
       optional,
       "of the lens; NETD is referred to the scene and already contains it"},
      {"bits", &SensorSpec::bits, KeyRange::between(8, 16), optional, "significant bits of a count"},
      {"offset_k", &SensorSpec::offset_k, KeyRange::any(), optional, "temperature of count 0"},
      {"frame_rate_hz", &SensorSpec::frame_rate_hz, KeyRange::positive(), optional, "frames per second"},
      {"scene_temperature_k", &SensorSpec::scene_temperature_k, KeyRange::between(50, 5000), optional,
       "of the surround; weights the wavelengths"},
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
