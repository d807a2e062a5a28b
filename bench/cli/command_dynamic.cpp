// SPDX-License-Identifier: GPL-3.0-or-later
// todbench dynamic
#include "bench/cli/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "bench/cli/chain_options.h"
#include "bench/cli/effect_decisions.h"
#include "bench/cli/run_display.h"
#include "bench/cli/seeded_plan.h"
#include "bench/judgement/verdict_record.h"
#include "bench/moving_target/dynamic_json.h"
#include "bench/moving_target/dynamic_session.h"
#include "bench/plan/descriptions.h"
#include "bench/session/json_output.h"
#include "bench/session/session_folder.h"
#include "bench/text/text.h"
#include "sim_devices/prediction/effect_planner.h"
#include "tod/plate/test_pattern.h"
#include "tod/psychometric/acuity.h"

namespace todbench {
namespace {

struct DynamicArguments {
  std::string plan, out, sensor = "sc2000", observer = "hvs-1", display, accuracy = "normal", package;
  bool overwrite = false;
  double delta_t_k = 16.9;
  std::vector<double> speeds_mrad_s, sizes_pitch;
  int passes = 48, frames = 8;
  double time_constant_ms = -1, exposure_ms = -1, row_time_us = -1, field_delay_ms = -1;
  std::optional<double> tolerance_percent;
  EffectDecisionOptions decisions;
};

/// `with_spread`: adds acuity and ratio over the open parameters of an observer with an eye.
void add_rows(std::vector<TableRow>& rows, const std::vector<DynamicAcuity>& found, const TableRow& first,
              bool with_spread) {
  for (const DynamicAcuity& at : found) {
    for (const DynamicPoint& point : at.points) {
      TableRow row = first;
      const TableRow cells{fmt::format("{:g}", at.speed_mrad_s),
                           fmt::format("{:.3g}", at.speed_px),
                           std::string(to_string(point.observer)),
                           fixed(stated_acuity_per_mrad(point.fit), 3),
                           range(acuity_interval(point.fit.ci95), 3),
                           fixed(point.ratio, 3),
                           range(point.ratio_ci95, 3)};
      row.insert(row.end(), cells.begin(), cells.end());
      if (with_spread) {
        const auto acuity = acuity_spread_per_mrad(point.s75_spread_mrad);
        row.push_back(acuity ? range(*acuity, 3) : "-");
        row.push_back(point.ratio_spread ? range({point.ratio_spread->first, point.ratio_spread->second}, 3) : "-");
      }
      rows.push_back(std::move(row));
    }
  }
}

/// Header of the table after the columns of `first`.
TableRow header_after(TableRow first, bool with_spread) {
  for (const char* name :
       {"speed (mrad/s)", "px/frame", "observer", "acuity (1/mrad)", "95 %", "ratio to rest", "95 %"})
    first.emplace_back(name);
  if (with_spread) first.emplace_back("acuity, open parameters"), first.emplace_back("ratio, open parameters");
  return first;
}

int run_dynamic_plan(Console& console, const DynamicArguments& a, const Program& program) {
  const auto loaded = with_seed(read_plan(a.plan), program.common);
  if (!loaded) return report_error(console, loaded.error());
  const Plan& plan = loaded->plan();
  console.phase("measuring a moving target");
  const auto said = [&](const MovingPassRecord& pass) {
    if (!pass.dropped.empty() && !console.json()) console.text(fmt::format("pass {}: {}", pass.pass, pass.dropped));
  };
  const ExperimentOptions options{
      .folder = a.out.empty() ? std::filesystem::path(session_folder_name(plan.name)) : std::filesystem::path(a.out),
      .existing = a.overwrite     ? ExistingFolder::overwrite
                  : a.out.empty() ? ExistingFolder::number
                                  : ExistingFolder::refuse};
  const auto session = measure_dynamic_session(*loaded, options, listener_of(console), said, program.stop->token());
  if (!session) return report_error(console, session.error());
  const DynamicMeasurement* const found = &session->found;
  const ExperimentOutcome& outcome = session->outcome;
  if (console.json()) {
    Json json = dynamic_measurement_json(*found, plan);
    json["verdict"] = to_string(outcome.verdict.decision);
    json["judgement"] = verdict_json(outcome.verdict);
    json["session"] = outcome.folder.string();
    console.object(json);
  }
  std::vector<TableRow> rows;
  const bool with_spread = loaded->observer().eye.has_value();
  for (const DynamicContrast& at : found->contrasts)
    add_rows(rows, at.speeds, {fmt::format("{:g}", at.set_delta_t_k)}, with_spread);
  console.table(header_after({"set contrast (K)"}, with_spread), rows);
  console.text(fmt::format("the large triangles deviate from the motion reported by the stage by {:.3f} px (rms)",
                           found->residual_px));
  if (const auto& tau = found->time_constant)
    console.text(fmt::format("time constant {:.2f} ms, 95 % {}, from {} passes in both directions",
                             tau->time_constant_ms, range(tau->ci95_ms, 2), tau->passes));
  console.text("report: " + (outcome.folder / "report.html").string());
  if (outcome.ended_by) return report_error(console, *outcome.ended_by);
  // A plan without limits needs no verdict.
  if (plan.limits.acuity.empty()) return 0;
  console.text("verdict for the plate at rest: " + std::string(to_string(outcome.verdict.decision)));
  return exit_code(outcome.verdict.decision);
}

Json dynamic_json(const DynamicAcuities& found, const SensorSpec& sensor, const DynamicArguments& a,
                  std::uint64_t seed) {
  return {{"sensor", sensor.name},
          {"observer", a.observer},
          {"delta_t_k", a.delta_t_k},
          {"time_constant_ms", sensor.time_constant_ms},
          {"exposure_ms", sensor.exposure_ms},
          {"row_time_us", sensor.row_time_us},
          {"field_delay_ms", sensor.field_delay_ms},
          {"frame_rate_hz", sensor.frame_rate_hz},
          {"frames", a.frames},
          {"passes", a.passes},
          {"direction", "x, both ways in turn"},
          {"package", a.package.empty() ? Json() : Json(a.package)},
          {"lag", a.package.empty() ? "removed" : "removed for time constant and exposure, not for the package"},
          {"internal_noise", "per decision"},
          {"seed", seed},
          {"speeds", speeds_json(found.speeds)},
          {"notes", found.notes}};
}

/// Effects of the sensor with the plate at rest and at the highest speed. Without a tolerance every effect that is not
/// neutral is simulated.
Result<DecidedEffects> planned_for(const SensorSpec& sensor, const TemplateObserverSpec& observer,
                                   const DynamicArguments& a) {
  const SceneMotion fastest{.x_mrad_s = *std::ranges::max_element(a.speeds_mrad_s), .y_mrad_s = 0};
  if (!a.tolerance_percent) {
    return DecidedEffects{
        sensor.name, full_plan(sensor, {}, {}, fastest),
        "every effect that is not neutral is simulated; --tolerance-percent leaves out negligible ones"};
  }
  if (!a.package.empty())
    return fail(ErrorCode::invalid_input,
                "--tolerance-percent: the criteria of the planner hold for the sensor alone, not behind --package");
  EffectPlanner planner;
  EffectPlannerOptions tolerance;
  tolerance.tolerance_percent = *a.tolerance_percent;
  DecidedEffects decided{sensor.name, {}, ""};
  double change_percent = 0;
  for (const SceneMotion& motion : {SceneMotion{}, fastest}) {
    const auto plan = planner.plan(sensor, observer, {.delta_t_k = {a.delta_t_k}, .motion = motion}, tolerance);
    if (!plan) return tl::unexpected(plan.error());
    change_percent = std::max(change_percent, plan->skipped_change_percent);
    if (decided.plan.decisions.empty()) decided.plan = plan->plan;
    for (std::size_t i = 0; i < plan->plan.decisions.size(); ++i) {
      const EffectDecision& other = plan->plan.decisions[i];
      EffectDecision& one = decided.plan.decisions[i];
      // An effect that matters at rest or in motion is simulated at every speed.
      if (one.decision == Decision::skip &&
          (other.decision == Decision::simulate ||
           other.predicted_change_percent.value_or(0) > one.predicted_change_percent.value_or(0)))
        one = other;
    }
  }
  decided.promise = fmt::format(
      "the effects that are left out change the acuity by at most {:.2g} % together, at rest and at {:g} mrad/s; {:g} "
      "% "
      "are allowed",
      change_percent, fastest.x_mrad_s, *a.tolerance_percent);
  return decided;
}

int run_dynamic(Console& console, const DynamicArguments& a, const Program& program) {
  if (!a.plan.empty()) return run_dynamic_plan(console, a, program);
  if (a.speeds_mrad_s.empty())
    return report_error(console, {ErrorCode::invalid_input, "a plan or --speeds-mrad-s is required"});
  auto sensor = load_sensor(a.sensor);
  if (!sensor) return report_error(console, sensor.error());
  if (a.time_constant_ms >= 0) sensor->time_constant_ms = a.time_constant_ms;
  if (a.exposure_ms >= 0) sensor->exposure_ms = a.exposure_ms;
  if (a.row_time_us >= 0) sensor->row_time_us = a.row_time_us;
  if (a.field_delay_ms >= 0) sensor->field_delay_ms = a.field_delay_ms;
  if (auto valid = validate(*sensor); !valid) return report_error(console, valid.error());
  const auto spec = load_observer_at(a.observer, a.display);
  if (!spec) return report_error(console, spec.error());
  const auto effects = planned_for(*sensor, *spec, a);
  if (!effects) return report_error(console, effects.error());
  if (a.decisions.dry_run) return dry_run(console, {*effects}, a.decisions);
  TemplateObserver observer(*spec, triangle_alternatives());
  DynamicTrialOptions options{.delta_t_k = a.delta_t_k,
                              .sizes_pitch = a.sizes_pitch,
                              .speeds_mrad_s = a.speeds_mrad_s,
                              .passes = a.passes,
                              .frames = a.frames,
                              .accuracy = a.accuracy == "draft" ? Accuracy::draft() : Accuracy::normal(),
                              .seed = program.common.seed,
                              .stop = program.stop->token()};
  EnhancementPackage package;
  if (!a.package.empty()) {
    auto read = read_package(a.package);
    if (!read) return report_error(console, read.error());
    package = *std::move(read);
    if (auto same = refuse_finer_pictures(package, "a moving target"); !same)
      return report_error(console, same.error());
    options.stages = [&package] { return made_stages(package, {}); };
  }
  console.phase("simulating " + sensor->name + " with a moving target");
  const SensorSpec simulated = a.tolerance_percent ? as_planned(*sensor, effects->plan) : *sensor;
  const auto found = dynamic_acuity(simulated, observer, std::move(options));
  if (!found) return report_error(console, found.error());
  if (console.json()) {
    Json json = dynamic_json(*found, *sensor, a, program.common.seed);
    add_effects(json, *effects);
    console.object(json);
  }
  std::vector<TableRow> rows;
  add_rows(rows, found->speeds, {}, spec->eye.has_value());
  console.table(header_after({}, spec->eye.has_value()), rows);
  for (const std::string& sentence : found->notes) console.note(sentence);
  print_effects(console, *effects, a.decisions);
  return 0;
}

}  // namespace

void add_dynamic_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand(
      "dynamic", "acuity for a moving target, compared with a target at rest: simulated or measured");
  auto a = std::make_shared<DynamicArguments>();
  auto* plan = command->add_option(
      "plan", a->plan, "plan: name or file; measures with its camera while the plate moves as [motion] states");
  auto* out = command->add_option("--out", a->out,
                                  "session folder, only with a plan; default: session-TIME-NAME in the current folder");
  auto* force = command->add_flag("--force", a->overwrite, "overwrites the session in an existing folder");
  out->needs(plan);
  force->needs(plan);
  command->add_option("--sensor", a->sensor, "sensor: name or file")->capture_default_str();
  command->add_option("--observer", a->observer, "observer: name or file")->capture_default_str();
  add_display_option(*command, a->display);
  command->add_option("--delta-t-k", a->delta_t_k, "set contrast in K")
      ->capture_default_str()
      ->check(number_in(-1000, 1000, "k"));
  command->add_option("--speeds-mrad-s", a->speeds_mrad_s, "speeds along x in mrad/s; 0 is added")
      ->expected(1, 32)
      ->check(number_in(0, 1e6));
  command->add_option("--frames", a->frames, "frames per pass")->capture_default_str()->check(whole_number(1, 64));
  command->add_option("--passes", a->passes, "passes per speed, alternately to the right and to the left")
      ->capture_default_str()
      ->check(whole_number(2, 10000));
  command
      ->add_option("--sizes-pitch", a->sizes_pitch,
                   "sizes of the triangles in detector pitches; default: sizes around the threshold")
      ->expected(2, 32)
      ->check(number_in(0.1, 40));
  command
      ->add_option("--time-constant-ms", a->time_constant_ms,
                   "time constant of the detector in ms; default: the value of the sensor")
      ->check(number_in(0, 1000, "ms"));
  command->add_option("--exposure-ms", a->exposure_ms, "exposure time in ms; default: the value of the sensor")
      ->check(number_in(0, 1000, "ms"));
  command->add_option("--row-time-us", a->row_time_us, "readout time per row in us; default: the value of the sensor")
      ->check(number_in(0, 1e4, "us"));
  command
      ->add_option("--field-delay-ms", a->field_delay_ms,
                   "time from the even to the odd rows of an interlaced frame in ms; default: the value of the sensor")
      ->check(number_in(0, 1000, "ms"));
  command->add_option("--package", a->package,
                      "package of stages behind the camera, a file; the lag of the stages is not removed");
  command
      ->add_option("--tolerance-percent", a->tolerance_percent,
                   "leaves out effects that together change the acuity by at most this percentage, at rest and at the "
                   "highest speed; default: none")
      ->check(number_in(0.01, 50));
  a->decisions.add_to(*command);
  command->add_option("--accuracy", a->accuracy, "accuracy of the simulation")
      ->capture_default_str()
      ->check(CLI::IsMember({"draft", "normal"}));
  for (CLI::Option* option : command->get_options()) {
    if (option != plan && option != out && option != force && option != command->get_help_ptr()) option->excludes(plan);
  }
  finish_command(*command, program, [a, &program](Console& console) { return run_dynamic(console, *a, program); });
}

}  // namespace todbench
