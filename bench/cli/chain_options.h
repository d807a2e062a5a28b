// The options of commands that look at a scene through air with a sensor.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "acquisition/core/accuracy.h"
#include "bench/plan/atmospheres.h"
#include "bench/plan/descriptions.h"

namespace todbench {

/// What stands between a scene and the answer.
struct SeeingChain {
  SensorSpec sensor;
  TemplateObserverSpec observer;
  Accuracy accuracy;
  Atmosphere air;
};

/// Must live as long as the command.
struct ChainOptions {
  std::string sensor, observer = "hvs-1", atmosphere = "clear", haze = "rural-23km", accuracy = "normal";
  double extinction_per_km = 0;
  int microscan = 0;  ///< 0: the sensor's own

  /// --sensor, which is required.
  void add_sensor_to(CLI::App& command);
  /// All others.
  void add_to(CLI::App& command, const std::string& sentence_of_observer);
  /// Reads what they name. Errors: as the loaders.
  [[nodiscard]] Result<SeeingChain> load() const;
};

}  // namespace todbench
