// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/sweep/task_plan.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/forecast/default_design.h"
#include "bench/forecast/time_prediction.h"
#include "bench/judgement/verdict.h"
#include "bench/plan/descriptions.h"
#include "bench/plan/plan_keys.h"
#include "bench/plan/plan_options.h"
#include "bench/run/experiment.h"
#include "bench/session/json_output.h"
#include "bench/sweep/identify_task.h"
#include "bench/text/files.h"
#include "bench/text/text.h"
#include "bench/twin/experiment_inputs.h"
#include "bench/twin/module_chain.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "sim_devices/sensor/sensor_key.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

/// Converts an option of `todbench simulate` to a key: "--delta-t-k" to "delta_t_k".
std::string key_of_option(std::string_view option) {
  std::string key(option.substr(2));
  std::replace(key.begin(), key.end(), '-', '_');
  return key;
}

/// Returns the key of the plan for a name; empty for a name of the sensor.
std::optional<std::string> plan_path(std::string_view name) {
  for (const auto& section : plan_sections()) {
    if (section.repeated()) continue;
    for (const auto& key : section.keys) {
      const std::string path = path_of(section, key);
      const bool option =
          key.option.of == OptionOf::simulations && !key.option.name.empty() && key_of_option(key.option.name) == name;
      if (path == name || option) return path;
    }
  }
  return std::nullopt;
}

std::optional<SensorKey> sensor_key(std::string_view name) {
  if (name.starts_with("sensor.")) name.remove_prefix(7);
  for (const auto& key : sensor_keys()) {
    if (key.name == name) return key;
  }
  return std::nullopt;
}

std::vector<std::string> known_keys() {
  std::vector<std::string> keys;
  for (const auto& key : sensor_keys()) keys.emplace_back(key.name);
  for (const auto& section : plan_sections()) {
    for (const auto& key : section.keys) {
      if (section.repeated()) continue;
      keys.push_back(path_of(section, key));
      if (!key.option.name.empty() && key.option.of == OptionOf::simulations)
        keys.push_back(key_of_option(key.option.name));
    }
  }
  return keys;
}

Result<void> set_sensor(const SweepParameter& parameter, const SensorKey& key, SensorSpec& spec) {
  if (const auto* shown = std::get_if<DisplayReconstruction SensorSpec::*>(&key.member)) {
    for (const auto value : {DisplayReconstruction::sample_and_hold, DisplayReconstruction::bilinear}) {
      if (to_string(value) != parameter.value) continue;
      spec.*(*shown) = value;
      return {};
    }
    return fail_at(ErrorCode::invalid_input, parameter.key,
                   "'" + one_line(parameter.value) + "' is not a display reconstruction");
  }
  const auto number = parse_number(parameter.value);
  const auto* whole = std::get_if<int SensorSpec::*>(&key.member);
  if (!number || !key.range.contains(*number) || (whole != nullptr && *number != std::floor(*number)) ||
      std::abs(*number) > 1e9) {
    return fail_at(ErrorCode::invalid_input, parameter.key,
                   "expected " + key.range.describe() + (whole != nullptr ? ", whole" : "") + ", found '" +
                       one_line(parameter.value) + "'");
  }
  if (whole != nullptr) {
    spec.*(*whole) = static_cast<int>(*number);
  } else {
    spec.*std::get<double SensorSpec::*>(key.member) = *number;
  }
  return {};
}

Result<void> set_plan(const SweepParameter& parameter, const std::string& path, const std::filesystem::path& folder,
                      Plan& plan) {
  const KeyAt at = plan_key(path);
  auto value = value_from_text(at.key->type, parameter.value);
  if (!value) return fail_at(ErrorCode::invalid_input, parameter.key, value.error().message);
  if (std::holds_alternative<ResourceKey>(at.key->type))
    value = KeyValue(absolute_reference(std::get<std::string>(*value), folder));
  if (std::holds_alternative<ResourcesKey>(at.key->type)) {
    for (auto& reference : std::get<std::vector<std::string>>(*value))
      reference = absolute_reference(reference, folder);
  }
  at.key->place.set(plan, 0, *value);
  return {};
}

std::vector<SweepAxis> axes_of(const SweepFile& file) {
  std::vector<SweepAxis> axes = file.grid;
  axes.insert(axes.end(), file.zip.begin(), file.zip.end());
  for (const auto& [key, low, high] : file.sample) axes.push_back({key, {number_text(low), number_text(high)}});
  return axes;
}

/// Applies the parameters in order: those of the plan, then, for the resulting sensor, those of the sensor. Those of an
/// identification are left out.
Result<LoadedPlan> applied(const LoadedPlan& base, std::vector<SweepParameter> parameters, const SweepFile& file,
                           std::uint64_t seed) {
  if (file.kind == TaskKind::identify)
    std::erase_if(parameters, [](const auto& parameter) { return is_identification_key(parameter.key); });
  Plan plan = base.plan();
  plan.seed = seed;
  bool new_sensor = false, new_microscan = false;
  for (const auto& parameter : parameters) {
    const auto path = plan_path(parameter.key);
    if (!path) continue;
    TODBENCH_TRY_VOID(set_plan(parameter, *path, file.folder, plan));
    new_sensor |= *path == "simulation.sensor";
    new_microscan |= *path == "simulation.microscan";
  }
  auto loaded = base.with(plan);
  if (!loaded) return loaded;
  PlanParts parts = loaded->parts();
  // A sensor brings its own microscan, as on the command line.
  if (new_sensor && !new_microscan) plan.simulation.microscan = parts.sensor.microscan;
  for (const auto& parameter : parameters) {
    if (plan_path(parameter.key)) continue;
    const auto key = sensor_key(parameter.key);
    if (!key)
      return fail(ErrorCode::invalid_input, "unknown parameter '" + one_line(parameter.key) + "'" +
                                                nearest_name_hint(parameter.key, known_keys()));
    TODBENCH_TRY_VOID(set_sensor(parameter, *key, parts.sensor));
  }
  TODBENCH_TRY_VOID(validate(parts.sensor));
  return LoadedPlan::of(std::move(plan), std::move(parts));
}

/// Removes a base key from the list and returns its value.
std::optional<std::string> taken(std::vector<SweepParameter>& base, std::string_view key) {
  const auto found = std::find_if(base.begin(), base.end(), [&](const auto& p) { return p.key == key; });
  if (found == base.end()) return std::nullopt;
  std::string value = found->value;
  base.erase(found);
  return value;
}

/// Checks every value of every axis with the base: a value that is invalid alone is always invalid.
Result<void> check_values(const LoadedPlan& initial, const std::vector<SweepParameter>& base, const SweepFile& file) {
  const bool identifies = file.kind == TaskKind::identify;
  const auto check = [&](const std::string& key, const std::string& value) -> Result<void> {
    std::vector<SweepParameter> parameters = base;
    parameters.push_back({key, value});
    const auto loaded = applied(initial, parameters, file, 1);
    if (loaded && identifies && is_identification_key(key)) {
      if (auto task = identification_task(parameters, file.folder, *loaded, {}); !task)
        return tl::unexpected(task.error());
    }
    // Two values that limit each other may change together; the tasks report invalid combinations.
    if (loaded || (plan_path(key) == std::nullopt && sensor_key(key) && loaded.error().key == std::nullopt)) return {};
    return tl::unexpected(loaded.error());
  };
  for (const auto& axis : axes_of(file)) {
    constexpr std::size_t enough = 200;
    for (std::size_t i = 0; i < std::min(axis.values.size(), enough); ++i) {
      TODBENCH_TRY_VOID(check(axis.key, axis.values[i]));
    }
  }
  return {};
}

/// Names of the effects that the tolerance leaves out although they change the sensor, separated by spaces.
std::string below_tolerance(const SensorPlan& effects) {
  std::string names;
  for (const EffectDecision& effect : effects.decisions) {
    if (effect.decision != Decision::skip || effect.changes_nothing() || effect.on_request) continue;
    names += (names.empty() ? "" : " ") + std::string(to_string(effect.effect));
  }
  return names;
}

/// `left_out`: of the estimate, if the sweep states a tolerance.
Json estimate_json(const LoadedPlan& plan, const std::vector<DirectPoint>& points,
                   const std::optional<std::string>& left_out) {
  Json list = Json::array();
  const double pitch_mrad = plan.sensor().ifov_mrad();
  for (const auto& point : points) {
    list.push_back({{"delta_t_k", point.delta_t_k},
                    {"s75_direct_mrad", point.s75_pitch * pitch_mrad},
                    {"s75_direct_se_mrad", point.standard_error_pitch * pitch_mrad},
                    {"acuity_per_mrad", 1 / (point.s75_pitch * pitch_mrad)}});
    if (left_out) list.back()["left_out"] = *left_out;
  }
  return {{"points", list}};
}

/// Returns whether the base or an axis of a task states the tolerance.
bool states_tolerance(const RunnableSweep& runnable, const SweepTask& task) {
  const auto is_tolerance = [](const SweepParameter& parameter) {
    return plan_path(parameter.key) == "simulation.tolerance_percent";
  };
  return std::ranges::any_of(runnable.base, is_tolerance) || std::ranges::any_of(task.parameters, is_tolerance);
}

/// Inputs of the direct estimate of a task. If the sweep states a tolerance, effects that the scene does not call for
/// are skipped; otherwise every effect is simulated, so that tasks differ by their parameters alone.
Result<ExperimentInputs> estimate_inputs(const RunnableSweep& runnable, const SweepTask& task, const LoadedPlan& plan) {
  TODBENCH_TRY_VOID(refuse_modules(plan.plan(), plan.sensor()));
  EffectPlanner planner;
  TODBENCH_TRY(auto inputs, experiment_inputs(plan, planner));
  if (states_tolerance(runnable, task)) return inputs;
  const SimulationPlan& simulation = plan.plan().simulation;
  inputs.effects = full_plan(plan.sensor(), simulation.skip, simulation.force, simulation.motion);
  inputs.sensor = plan.sensor();
  return inputs;
}

Result<Json> estimated(const RunnableSweep& runnable, const SweepTask& task, const LoadedPlan& plan,
                       std::stop_token stop) {
  TODBENCH_TRY(const auto inputs, estimate_inputs(runnable, task, plan));
  TemplateObserver observer(inputs.observer, triangle_alternatives());
  TODBENCH_TRY(
      const auto points,
      direct_estimate(
          inputs.sensor, inputs.effects, observer, plan.plan().target.delta_t_k,
          {.motion = inputs.motion, .accuracy = inputs.accuracy, .seed = plan.plan().seed, .stop = std::move(stop)}));
  return estimate_json(
      plan, points, states_tolerance(runnable, task) ? std::optional(below_tolerance(inputs.effects)) : std::nullopt);
}

/// Everything that the sets and airs of the base and of all axes have in their files.
Result<std::string> fingerprint_of_sets(const std::vector<SweepParameter>& base, const SweepFile& file) {
  TODBENCH_TRY(std::string text, identification_fingerprint(base, file.folder));
  for (const auto& axis : axes_of(file)) {
    if (axis.key != "set" && axis.key != "atmosphere") continue;
    for (const auto& value : axis.values) {
      std::vector<SweepParameter> parameters = base;
      parameters.push_back({axis.key, value});
      TODBENCH_TRY(const auto content, identification_fingerprint(parameters, file.folder));
      text += content;
    }
  }
  return text;
}

/// The study of a task of kind `identify`.
Result<IdentificationStudyTask> study_of(const RunnableSweep& runnable, const SweepTask& task, const LoadedPlan& plan,
                                         std::stop_token stop) {
  TODBENCH_TRY_VOID(refuse_modules(plan.plan(), plan.sensor()));
  std::vector<SweepParameter> parameters = runnable.base;
  parameters.insert(parameters.end(), task.parameters.begin(), task.parameters.end());
  return identification_task(parameters, runnable.sweep.file().folder, plan, std::move(stop));
}

Result<Json> simulated(const LoadedPlan& plan, const std::filesystem::path& scratch, std::stop_token stop) {
  const auto outcome = simulate_plan(plan, {.folder = scratch, .existing = ExistingFolder::overwrite}, {}, stop);
  std::error_code ignored;
  std::filesystem::remove_all(scratch, ignored);
  if (!outcome) return tl::unexpected(outcome.error());
  if (outcome->ended_by) return tl::unexpected(*outcome->ended_by);
  Json points = curve_json(outcome->curve, outcome->effects, {})["points"];
  // Tables have no column of exit codes: a number that a measurement would reject is left empty.
  for (std::size_t i = 0; i < points.size(); ++i) {
    const TodPoint& point = outcome->curve.points[i];
    if (exit_code(point.fit, point.adequacy.value_or(Adequacy{})) == 0) continue;
    points[i]["s75_mrad"] = points[i]["acuity_per_mrad"] = nullptr;
    points[i]["s75_ci95_mrad"] = json_interval({});
  }
  return Json{{"points", points}};
}

}  // namespace

Result<RunnableSweep> load_sweep(const std::filesystem::path& path) {
  TODBENCH_TRY(auto file, read_sweep(path));
  std::vector<SweepParameter> base = file.base;
  const auto plan = taken(base, "plan");
  const std::string reference = plan ? absolute_reference(*plan, file.folder) : "demo";
  auto initial = read_plan(reference);
  if (initial && !plan) initial = initial->with(plan_of_nobody(initial->plan()));
  if (!initial) return fail(path.string(), initial.error());
  const auto loaded = applied(*initial, base, file, initial->plan().seed);
  if (!loaded) return fail(path.string(), loaded.error());
  if (auto fine = check_values(*initial, base, file); !fine) return fail(path.string(), fine.error());
  // The contents of named files affect results as well.
  std::string fingerprint = "plan " + sha256_of(to_toml(loaded->plan())) + "\n";
  for (const auto& [name, source] : loaded->parts().sources) fingerprint += sha256_of(source.text) + "\n";
  for (const auto* modules : {&loaded->plan().modules, &loaded->sensor().modules}) {
    for (const ModulePlan& module : *modules) fingerprint += text_of(module_record(module)) + "\n";
  }
  if (file.kind == TaskKind::identify) {
    TODBENCH_TRY(const auto content, fingerprint_of_sets(base, file));
    fingerprint += content;
  }
  const SensorSpec sensor = loaded->sensor();
  const auto number_of = [&sensor](std::string_view name) -> std::optional<double> {
    const auto key = sensor_key(name);
    if (!key) return std::nullopt;
    if (const auto* number = std::get_if<double SensorSpec::*>(&key->member)) return sensor.*(*number);
    if (const auto* whole = std::get_if<int SensorSpec::*>(&key->member)) return sensor.*(*whole);
    return std::nullopt;
  };
  auto sweep = Sweep::expand(std::move(file), std::move(fingerprint), number_of);
  if (!sweep) return fail(path.string(), sweep.error());
  RunnableSweep runnable{*std::move(sweep), *std::move(initial), std::move(base)};
  if (runnable.sweep.file().kind == TaskKind::identify) {
    // The base alone may lack what an axis states; the first task has everything.
    const SweepTask first = runnable.sweep.task(0);
    const auto first_plan = task_plan(runnable, first, {});
    if (!first_plan) return fail(path.string(), first_plan.error());
    if (auto study = study_of(runnable, first, *first_plan, {}); !study) return fail(path.string(), study.error());
  }
  return runnable;
}

Result<LoadedPlan> task_plan(const RunnableSweep& runnable, const SweepTask& task, std::stop_token stop) {
  const SweepFile& file = runnable.sweep.file();
  std::vector<SweepParameter> parameters = runnable.base;
  parameters.insert(parameters.end(), task.parameters.begin(), task.parameters.end());
  auto plan = applied(runnable.initial, parameters, file, task.seed);
  if (!plan || file.kind != TaskKind::simulate) return plan;
  const bool own_plan =
      std::any_of(file.base.begin(), file.base.end(), [](const auto& parameter) { return parameter.key == "plan"; });
  return own_plan ? plan : with_suitable_distance(*plan, std::move(stop));
}

Result<Json> run_task(const RunnableSweep& runnable, const SweepTask& task, const std::filesystem::path& scratch,
                      std::stop_token stop) {
  TODBENCH_TRY(const auto plan, task_plan(runnable, task, stop));
  switch (runnable.sweep.file().kind) {
    case TaskKind::estimate:
      return estimated(runnable, task, plan, stop);
    case TaskKind::identify: {
      TODBENCH_TRY(const auto study, study_of(runnable, task, plan, stop));
      return identified(study);
    }
    case TaskKind::simulate:
      break;
  }
  return simulated(plan, scratch, stop);
}

Result<double> predicted_task_s(const RunnableSweep& runnable, const SweepTask& task, std::stop_token stop) {
  TODBENCH_TRY(const auto plan, task_plan(runnable, task, stop));
  if (runnable.sweep.file().kind == TaskKind::estimate) {
    TODBENCH_TRY(const auto estimate, estimate_inputs(runnable, task, plan));
    return predict_estimate_s(estimate, stop);
  }
  if (runnable.sweep.file().kind == TaskKind::identify) {
    // The TOD curve for M75 takes about as long as a direct estimate.
    TODBENCH_TRY(const auto study, study_of(runnable, task, plan, stop));
    TODBENCH_TRY(const auto experiment, experiment_of(study));
    TODBENCH_TRY(const auto effort, planned_effort(experiment));
    TODBENCH_TRY(const auto estimate, estimate_inputs(runnable, task, plan));
    TODBENCH_TRY(const double curve_s, predict_estimate_s(estimate, stop));
    return effort.processor_s + curve_s;
  }
  EffectPlanner planner;
  TODBENCH_TRY(const auto inputs, experiment_inputs(plan, planner));
  TODBENCH_TRY(const auto time, predict_time(plan.plan(), inputs, stop));
  return time.simulation_s;
}

}  // namespace todbench
