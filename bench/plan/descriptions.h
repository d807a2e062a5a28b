// Sensors, observers and plates from their TOML files.
#pragma once

#include <optional>
#include <string_view>

#include "acquisition/core/result.h"
#include "bench/plan/resources.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/sensor/sensor_spec.h"
#include "tod/plate/target_plate.h"

namespace todbench {

class TomlReader;

/// An observer, and the program in place of its templates where its file has one.
struct DescribedObserver {
  TemplateObserverSpec spec;
  std::optional<ModulePlan> module;
};

/// By name ("sc2000") or file. `invalid_input` with file and line for a key that is unknown, missing or out of its
/// range, and for a description that is impossible as a whole. A key that may be missing has the default of its struct.
/// A sensor with modules is refused: what works with a SensorSpec alone would leave them out.
[[nodiscard]] Result<SensorSpec> load_sensor(std::string_view reference);
/// The same with its modules, for those who run them.
[[nodiscard]] Result<SensorSpec> load_sensor_with_modules(std::string_view reference);
/// One with a module is refused likewise: plans have a [[module]] of their own.
[[nodiscard]] Result<TemplateObserverSpec> load_observer(std::string_view reference);
/// Rows of cut-outs: [[row]] size_mm, y_mm, x_mm = [...], apex = ["up", ...], optionally names = [...]; without them
/// triangles are called "row R, triangle T", counted from 1. [[rectangle]] x_mm, y_mm, width_mm, height_mm, optionally
/// name and angle_deg.
[[nodiscard]] Result<TargetPlate> load_plate(std::string_view reference);

/// The keys of a module but its place, as in [[module]] of plans; what is wrong is said to the reader of the table.
[[nodiscard]] ModulePlan read_module(TomlReader& table);

/// The same from text already read.
[[nodiscard]] Result<SensorSpec> parse_sensor(const Resource& resource);
[[nodiscard]] Result<TemplateObserverSpec> parse_observer(const Resource& resource);
/// With its [[module]], of which one is allowed and whose place is the observer's, for those who run it.
[[nodiscard]] Result<DescribedObserver> parse_observer_with_module(const Resource& resource);
[[nodiscard]] Result<TargetPlate> parse_plate(const Resource& resource);

}  // namespace todbench
