// SPDX-License-Identifier: GPL-3.0-or-later
// Sensors, observers and plates from their TOML files.
#pragma once

#include <optional>
#include <string_view>

#include "acquisition/base/result.h"
#include "bench/plan/resources.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/sensor/sensor_spec.h"
#include "tod/plate/target_plate.h"

namespace todbench {

class TomlReader;

/// Observer, and the program that replaces its templates if its file names one.
struct DescribedObserver {
  TemplateObserverSpec spec;
  std::optional<ModulePlan> module;
};

/// Loads a sensor by name ("sc2000") or file. Optional keys have the defaults of the struct. Errors: `invalid_input`
/// with file and line (key unknown, missing or out of range; contradictory description; sensor with modules, because
/// users of a plain SensorSpec would ignore them).
[[nodiscard]] Result<SensorSpec> load_sensor(std::string_view reference);
/// Loads a sensor with its modules, for callers that run them.
[[nodiscard]] Result<SensorSpec> load_sensor_with_modules(std::string_view reference);
/// Loads an observer. Rejects an observer with a module, because plans have their own [[module]]. Rejects an observer
/// with an eye, because only a plan has a display.
[[nodiscard]] Result<TemplateObserverSpec> load_observer(std::string_view reference);
/// Loads an observer, with or without an eye, that looks at `display`.
[[nodiscard]] Result<TemplateObserverSpec> load_observer_at(std::string_view reference, const ViewedDisplay& display);
/// Fails if the observer has an eye, with the message "WORK does not model ...". Use it for work that does not model a
/// display.
[[nodiscard]] Result<void> refuse_eye(const TemplateObserverSpec& observer, std::string_view work);
/// Fails with `invalid_input` at `origin` if the observer has no eye. Use this function for work that requires an eye.
[[nodiscard]] Result<void> require_eye(const TemplateObserverSpec& observer, std::string_view origin);
/// Loads a plate. Rows of cut-outs: [[row]] size_mm, y_mm, x_mm = [...], apex = ["up", ...], optionally names = [...];
/// default names are "row R, triangle T", counted from 1. Rectangles: [[rectangle]] x_mm, y_mm, width_mm, height_mm,
/// optionally name and angle_deg.
[[nodiscard]] Result<TargetPlate> load_plate(std::string_view reference);

/// Reads the keys of a [[module]] except `place`. Mistakes are recorded in the reader of the table.
[[nodiscard]] ModulePlan read_module(TomlReader& table);

/// Parse text that is already read. Otherwise these functions behave like load_...().
[[nodiscard]] Result<SensorSpec> parse_sensor(const Resource& resource);
[[nodiscard]] Result<TemplateObserverSpec> parse_observer(const Resource& resource);
/// Parses an observer with its optional [[module]] (at most one, with place observer), for callers that run it.
[[nodiscard]] Result<DescribedObserver> parse_observer_with_module(const Resource& resource);
[[nodiscard]] Result<TargetPlate> parse_plate(const Resource& resource);

}  // namespace todbench
