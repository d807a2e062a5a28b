// SPDX-License-Identifier: GPL-3.0-or-later
// Options of commands that simulate a sensor viewing a scene through air.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "acquisition/base/accuracy.h"
#include "bench/plan/atmospheres.h"
#include "bench/plan/descriptions.h"

namespace todbench {

/// Parts of the chain between a scene and the answer of an observer.
struct SeeingChain {
  SensorSpec sensor;              ///< camera that exposes the scene
  TemplateObserverSpec observer;  ///< observer that answers, with its display if it has an eye
  Accuracy accuracy;              ///< numerical accuracy of the simulation
  Atmosphere air;                 ///< air between scene and camera
};

/// Adds the option --display: a plan whose section [display] describes the display for an observer with an eye.
/// `display` must outlive the parser.
void add_display_option(CLI::App& command, std::string& display);
/// Loads an observer by name or file. An observer with an eye requires `display`, the name or file of a plan with a
/// section [display]. Errors: those of parse_observer() and load_plan(); `invalid_input` for an eye without a display.
[[nodiscard]] Result<TemplateObserverSpec> load_observer_at(const std::string& observer, const std::string& display);

/// Command-line options that describe a chain. The object must outlive the parser.
struct ChainOptions {
  std::string sensor,            ///< --sensor: name or file of the camera
      observer = "hvs-1",        ///< --observer: name or file of the observer
      display,                   ///< --display: name or file of a plan with a section [display]; empty: no display
      atmosphere = "clear",      ///< --atmosphere: name of a shipped atmosphere, or file
      haze = "rural-23km",       ///< --haze: aerosol model of the shipped atmospheres
      accuracy = "normal";       ///< --accuracy: "draft", "normal" or "reference"
  double extinction_per_km = 0;  ///< --extinction-per-km: extinction coefficient of the contrast in 1/km
  int microscan = 0;             ///< --microscan: samples per pitch and axis; 0: value of the sensor file

  /// Adds the option --sensor, which is required.
  void add_sensor_to(CLI::App& command);
  /// Adds all other options. `sentence_of_observer`: help text of --observer.
  void add_to(CLI::App& command, const std::string& sentence_of_observer);
  /// Loads the parts that the options name. Errors: those of load_sensor(), load_observer_at() and load_atmosphere().
  [[nodiscard]] Result<SeeingChain> load() const;
};

}  // namespace todbench
