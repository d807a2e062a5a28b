// The keys of a sensor description: name, unit, range, default and what they mean, once for reader, check and tests.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Which numbers a key takes. Never NaN or infinite.
struct KeyRange {
  enum class Edge { included, excluded };
  double low = std::numeric_limits<double>::lowest();
  double high = std::numeric_limits<double>::max();
  Edge low_edge = Edge::included;
  [[nodiscard]] static constexpr KeyRange any() { return {}; }
  [[nodiscard]] static constexpr KeyRange positive() { return {0, std::numeric_limits<double>::max(), Edge::excluded}; }
  [[nodiscard]] static constexpr KeyRange not_negative() { return {.low = 0}; }
  [[nodiscard]] static constexpr KeyRange between(double low, double high) { return {.low = low, .high = high}; }
  [[nodiscard]] bool contains(double value) const;
  /// "above 0", "from 0 to 0.1", "0 or more", "a number".
  [[nodiscard]] std::string describe() const;
};

/// The parameter that a key sets: a number, a whole number, or the name of a display.
using KeyMember = std::variant<double SensorSpec::*, int SensorSpec::*, DisplayReconstruction SensorSpec::*>;

/// Whether a description has to have the key. Others have the value of a SensorSpec as it is made.
enum class KeyPresence { required, optional };

struct SensorKey {
  std::string_view name;  ///< as in the file; its ending is the unit
  KeyMember member;
  KeyRange range;
  KeyPresence presence = KeyPresence::optional;
  std::string_view meaning;  ///< a sentence without its full stop
};

/// Geometry and output of a camera: the keys that belong to no effect.
[[nodiscard]] const std::vector<SensorKey>& camera_keys();
/// All of them, those of effects in the order of the chain.
[[nodiscard]] std::vector<SensorKey> sensor_keys();

}  // namespace todbench
