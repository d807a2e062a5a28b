// SPDX-License-Identifier: GPL-3.0-or-later
// Options of commands that look at a scene through air with a sensor.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "acquisition/base/accuracy.h"
#include "bench/plan/atmospheres.h"
#include "bench/plan/descriptions.h"

namespace todbench {

/// The chain from a scene to the answer.
struct SeeingChain {
  SensorSpec sensor;
  TemplateObserverSpec observer;
  Accuracy accuracy;
  Atmosphere air;
};

/// Adds --display: the plan with the display of an observer with an eye.
void add_display_option(CLI::App& command, std::string& display);
/// Loads an observer. One with an eye needs the name or file of a plan with a section [display]. Errors: those of the
/// loaders; `invalid_input` for an eye without a display.
[[nodiscard]] Result<TemplateObserverSpec> load_observer_at(const std::string& observer, const std::string& display);

/// Lives as long as the command.
struct ChainOptions {
  std::string sensor, observer = "hvs-1", display, atmosphere = "clear", haze = "rural-23km", accuracy = "normal";
  double extinction_per_km = 0;
  int microscan = 0;  ///< 0: that of the sensor

  /// Adds --sensor, which is required.
  void add_sensor_to(CLI::App& command);
  /// Adds all other options.
  void add_to(CLI::App& command, const std::string& sentence_of_observer);
  /// Loads the named parts. Errors: those of the loaders.
  [[nodiscard]] Result<SeeingChain> load() const;
};

}  // namespace todbench
