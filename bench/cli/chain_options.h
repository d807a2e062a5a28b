// SPDX-License-Identifier: GPL-3.0-or-later
// Options of commands that observe a scene through air with a sensor.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "acquisition/base/accuracy.h"
#include "bench/plan/atmospheres.h"
#include "bench/plan/descriptions.h"

namespace todbench {

/// Parts of the chain from a scene to the answer of an observer.
struct SeeingChain {
  SensorSpec sensor;
  TemplateObserverSpec observer;
  Accuracy accuracy;
  Atmosphere air;
};

/// Adds --display: a plan that states the display for an observer with an eye. `display` must outlive the parser.
void add_display_option(CLI::App& command, std::string& display);
/// Loads an observer. An observer with an eye requires `display`, the name or file of a plan with a section [display].
/// Errors: those of the loaders; `invalid_input` for an eye without a display.
[[nodiscard]] Result<TemplateObserverSpec> load_observer_at(const std::string& observer, const std::string& display);

/// Options of a chain. They must outlive the parser.
struct ChainOptions {
  /// Names or files. `sensor`: sensor. `observer`: observer. `display`: plan that states the display for an observer
  /// with an eye; empty: none. `atmosphere`: air path. `haze`: aerosol of the shipped atmospheres. `accuracy`: draft,
  /// normal or reference.
  std::string sensor, observer = "hvs-1", display, atmosphere = "clear", haze = "rural-23km", accuracy = "normal";
  /// Extinction coefficient of the contrast in 1/km.
  double extinction_per_km = 0;
  int microscan = 0;  ///< samples per pitch and axis; 0: value of the sensor file

  /// Adds --sensor, which is required.
  void add_sensor_to(CLI::App& command);
  /// Adds all other options.
  void add_to(CLI::App& command, const std::string& sentence_of_observer);
  /// Loads the named parts. Errors: those of the loaders.
  [[nodiscard]] Result<SeeingChain> load() const;
};

}  // namespace todbench
