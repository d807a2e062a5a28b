// SPDX-License-Identifier: GPL-3.0-or-later
// The simulated effects of a command, as a table and as JSON: decided effects first, neutral ones in one line.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "bench/cli/console.h"
#include "bench/text/json.h"
#include "sim_devices/sensor/sensor_plan.h"

namespace todbench {

/// Options of a command that simulates a sensor. Lives as long as the command.
struct EffectDecisionOptions {
  bool why = false;      ///< neutral effects with their reasons
  bool dry_run = false;  ///< only states the effects
  void add_to(CLI::App& command);
};

/// Effects of one simulated sensor, with what they promise.
struct DecidedEffects {
  std::string sensor;
  SensorPlan plan;
  /// What the skipped effects change at most, or why none is skipped: a sentence.
  std::string promise;
};

/// Why a scene without criterion simulates every effect that is not neutral. `scene`: "bars", "the identification of
/// targets".
[[nodiscard]] std::string no_criterion_for(const std::string& scene);

/// Prints the table of decisions: effects that are neutral in the sensor in one line, or with their reasons.
void print_effect_table(const Console& console, const SensorPlan& plan, bool why);
void print_effects(const Console& console, const DecidedEffects& effects, const EffectDecisionOptions& options);
/// Adds "effects" as in `plan` and "promise".
void add_effects(Json& json, const DecidedEffects& effects);
/// Prints the effects of each sensor of a dry run, or its JSON object: {"effects", "promise"}, or {"models":
/// [{"sensor", "effects", "promise"}]} for several sensors. Returns the exit code.
[[nodiscard]] int dry_run(Console& console, const std::vector<DecidedEffects>& effects,
                          const EffectDecisionOptions& options);

}  // namespace todbench
