// The keys of a sensor description: name, unit, range, default and what they mean, once for reader, check and tests.
#pragma once

#include <string_view>
#include <variant>
#include <vector>

#include "acquisition/core/number_range.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// The parameter that a key sets: a number, a whole number, or the name of a display.
using KeyMember = std::variant<double SensorSpec::*, int SensorSpec::*, DisplayReconstruction SensorSpec::*>;

/// Whether a description has to have the key. Others have the value of a SensorSpec as it is made.
enum class KeyPresence { required, optional };

struct SensorKey {
  std::string_view name;  ///< as in the file; its ending is the unit
  KeyMember member;
  NumberRange range;
  KeyPresence presence = KeyPresence::optional;
  std::string_view meaning;  ///< a sentence without its full stop
};

/// Geometry and output of a camera: the keys that belong to no effect.
[[nodiscard]] const std::vector<SensorKey>& camera_keys();
/// All of them, those of effects in the order of the chain.
[[nodiscard]] std::vector<SensorKey> sensor_keys();

}  // namespace todbench
