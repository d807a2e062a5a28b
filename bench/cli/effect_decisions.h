// SPDX-License-Identifier: GPL-3.0-or-later
// Simulated effects of a command, as a table and as JSON. Effects that the planner decided come first. Neutral effects
// follow in one line; a neutral effect changes nothing in this sensor and is therefore skipped.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "bench/cli/console.h"
#include "bench/text/json.h"
#include "sim_devices/sensor/sensor_plan.h"

namespace todbench {

/// Help of the option --why.
inline constexpr const char* why_text =
    "states why each neutral effect is neutral, instead of one line for all of them";

/// Options of a command that simulates a sensor. They must outlive the parser.
struct EffectDecisionOptions {
  /// Lists neutral effects with their reasons, instead of in one line.
  bool why = false;
  /// Prints the effects and ends without a simulation.
  bool dry_run = false;
  void add_to(CLI::App& command);
};

/// Effects of one simulated sensor, with an upper bound on the error that the skipped effects cause.
struct DecidedEffects {
  std::string sensor;
  SensorPlan plan;
  /// Sentence with the largest change that the skipped effects cause, or with the reason why no effect is skipped.
  std::string promise;
};

/// Returns a sentence that every effect is simulated unless it is neutral, because the criteria of the planner hold for
/// triangles and not for this scene. `scene`: "the threshold of bars", "the identification of targets".
[[nodiscard]] std::string no_criterion_for(const std::string& scene);

/// Prints the table of decisions: effects that are neutral in the sensor in one line, or with their reasons.
void print_effect_table(const Console& console, const SensorPlan& plan, bool why);
/// Prints the effects of a sensor and the sentence `promise`.
void print_effects(const Console& console, const DecidedEffects& effects, const EffectDecisionOptions& options);
/// Adds the keys "effects" (as in the output of `todbench plan`) and "promise".
void add_effects(Json& json, const DecidedEffects& effects);
/// Prints the effects of each sensor of a dry run, or its JSON object: {"effects", "promise"}, or {"models":
/// [{"sensor", "effects", "promise"}]} for several sensors. Returns the exit code.
[[nodiscard]] int dry_run(Console& console, const std::vector<DecidedEffects>& effects,
                          const EffectDecisionOptions& options);

}  // namespace todbench
