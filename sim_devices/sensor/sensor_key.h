// SPDX-License-Identifier: GPL-3.0-or-later
// Keys of a sensor description: name, unit, range, default and meaning, stated once for reader, check and tests.
#pragma once

#include <string_view>
#include <variant>
#include <vector>

#include "acquisition/base/number_range.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Parameter that a key sets: a number, a whole number, or the name of a display.
using KeyMember = std::variant<double SensorSpec::*, int SensorSpec::*, DisplayReconstruction SensorSpec::*>;

/// Presence of the key in a description. An optional key has the default value of SensorSpec.
enum class KeyPresence { required, optional };

/// Key of a sensor description.
struct SensorKey {
  std::string_view name;  ///< as in the file; the ending is the unit
  KeyMember member;
  NumberRange range;
  KeyPresence presence = KeyPresence::optional;
  std::string_view meaning;  ///< a sentence without full stop
};

/// Returns the keys of geometry and output of a camera, which belong to no effect.
[[nodiscard]] const std::vector<SensorKey>& camera_keys();
/// Returns all keys. The keys of effects follow the order of the chain.
[[nodiscard]] std::vector<SensorKey> sensor_keys();

}  // namespace todbench
