// todbench measure, todbench simulate, todbench demo
#include <chrono>
#include <cmath>
#include <memory>

#include "bench/cli/commands.h"
#include "bench/cli/demonstration.h"
#include "bench/run/default_design.h"
#include "bench/run/experiment.h"
#include "bench/session/provenance.h"

namespace todbench {
namespace {

struct RunArguments {
  std::string plan;
  std::string out;
  std::vector<std::string> force;  ///< as a flag: overwrite; with values (simulate): effects
  bool forced = false;
};

struct SimulateArguments {
  RunArguments run;
  std::string sensor, observer, accuracy;
  int microscan = 0;
  double tolerance_percent = 0;
  std::vector<double> delta_t_k;
  std::vector<std::string> skip;
};

/// "session-20260131T123456Z-NAME" in the current folder.
std::string default_folder(const std::string& name) {
  std::string stamp;
  for (const char c : utc_now()) {
    if (c != '-' && c != ':') stamp += c;
  }
  std::string clean;
  for (const char c : name) clean += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' ? c : '_';
  return "session-" + stamp + "-" + clean;
}

ExperimentOptions folder_of(const RunArguments& arguments, const Plan& plan) {
  return {.folder = arguments.out.empty() ? default_folder(plan.name) : arguments.out,
          .existing = arguments.forced ? ExistingFolder::overwrite : ExistingFolder::refuse};
}

ExperimentListener listener_of(Console& console) {
  return {.on_phase = [&console](std::string_view phase) { console.phase(phase); },
          .on_progress = [&console](std::size_t done, std::size_t planned) { console.progress(done, planned); },
          .on_note = [&console](std::string_view sentence) { console.note(sentence); }};
}

void print_curve(const Console& console, const TodCurve& curve) {
  std::vector<TableRow> rows;
  for (const auto& point : curve.points) {
    rows.push_back({fixed(point.delta_t_k, 3), fixed(point.fit.threshold, 4), range(point.fit.ci95, 4),
                    fixed(acuity_per_mrad(point.fit), 4), range(acuity_interval(point.fit.ci95), 4),
                    fixed(point.direct_s75_mrad, 4), fixed(point.fit.trials, 0),
                    std::string(to_string(point.fit.verdict))});
  }
  console.text("TOD of " + curve.sensor + ", observer " + curve.observer);
  console.table({"dT [K]", "S75 [mrad]", "95 %", "acuity [1/mrad]", "95 %", "S75 direct [mrad]", "trials", "fit"},
                rows);
}

void print_comparison(const Console& console, const ExperimentOutcome& outcome) {
  std::vector<TableRow> rows;
  for (std::size_t i = 0; i < outcome.comparison->points.size(); ++i) {
    const auto& c = outcome.comparison->points[i];
    const auto find = [&](const TodCurve& curve) -> const TodPoint* {
      for (const auto& p : curve.points) {
        if (p.set_delta_t_k == c.set_delta_t_k) return &p;
      }
      return nullptr;
    };
    const TodPoint* real = find(outcome.curve);
    const TodPoint* twin = find(*outcome.twin);
    rows.push_back({fixed(c.delta_t_a_k, 3), real != nullptr ? fixed(acuity_per_mrad(real->fit), 4) : "–",
                    real != nullptr ? range(acuity_interval(real->fit.ci95), 4) : "–",
                    twin != nullptr ? fixed(acuity_per_mrad(twin->fit), 4) : "–",
                    twin != nullptr ? range(acuity_interval(twin->fit.ci95), 4) : "–", fixed(c.ratio, 3),
                    range(c.ratio_ci95, 3), std::string(to_string(c.verdict))});
  }
  console.table({"dT [K]", "acuity real [1/mrad]", "95 %", "acuity simulated", "95 %", "ratio", "95 %", "verdict"},
                rows);
}

void print_verdict(const Console& console, const Verdict& verdict) {
  for (const auto& item : verdict.items) {
    console.text(std::string(to_string(item.kind)) + ": " + item.demand +
                 (item.reason.empty() ? "" : " (" + item.reason + ")"));
  }
  console.text("verdict: " + std::string(to_string(verdict.overall)));
}

int finish(Console& console, const ExperimentOutcome& outcome) {
  console.note("session: " + outcome.folder.string());
  if (outcome.ended_by) {
    console.error("ended early: " + outcome.ended_by->message);
    return exit_code(outcome.ended_by->code);
  }
  return exit_code(outcome.verdict.overall);
}

int run_measure(Console& console, const RunArguments& arguments, const Program& program) {
  auto plan = load_plan(arguments.plan);
  if (!plan) return report_error(console, plan.error());
  if (program.common.seed_given) plan->seed = program.common.seed;
  auto outcome = measure_plan(*plan, folder_of(arguments, *plan), listener_of(console), program.stop->token());
  console.end_progress();
  if (!outcome) return report_error(console, outcome.error());
  if (console.json()) {
    console.object(curve_json(outcome->curve, {}, outcome->figures));
  } else {
    print_curve(console, outcome->curve);
    if (outcome->comparison) {
      console.text("");
      print_comparison(console, *outcome);
    }
    console.text("");
    print_verdict(console, outcome->verdict);
  }
  return finish(console, *outcome);
}

/// Overrides of the command line; names that are no effect are refused with the known ones.
Result<std::vector<Effect>> effects_of(const std::vector<std::string>& names, std::string_view option) {
  std::vector<Effect> effects;
  for (const auto& name : names) {
    const auto effect = effect_from(name);
    if (!effect) {
      std::string known;
      for (const Effect e : all_effects) known += (known.empty() ? "" : ", ") + std::string(to_string(e));
      return fail(ErrorCode::invalid_input, std::string(option) + " " + name + ": not an effect; known are " + known);
    }
    effects.push_back(*effect);
  }
  return effects;
}

Result<Plan> simulation_plan(SimulateArguments a, const Program& program) {
  // "--force" alone overwrites the folder; a value that is no effect is the plan that follows the flag.
  if (a.run.plan.empty() && !a.run.force.empty() && !effect_from(a.run.force.back())) {
    a.run.plan = a.run.force.back();
    a.run.force.pop_back();
  }
  auto plan = load_plan(a.run.plan.empty() ? "demo" : a.run.plan);
  if (!plan) return plan;
  if (program.common.seed_given) plan->seed = program.common.seed;
  if (!a.sensor.empty()) plan->simulation.sensor = a.sensor;
  if (!a.observer.empty()) plan->observer = a.observer;
  if (!a.accuracy.empty()) plan->simulation.accuracy = a.accuracy;
  if (a.microscan > 0) plan->simulation.microscan = a.microscan;
  if (a.tolerance_percent > 0) plan->simulation.tolerance_percent = a.tolerance_percent;
  if (!a.delta_t_k.empty()) plan->target.delta_t_k = a.delta_t_k;
  auto skip = effects_of(a.skip, "--skip");
  if (!skip) return tl::unexpected(skip.error());
  auto force = effects_of(a.run.force, "--force");
  if (!force) return tl::unexpected(force.error());
  plan->simulation.skip.insert(plan->simulation.skip.end(), skip->begin(), skip->end());
  plan->simulation.force.insert(plan->simulation.force.end(), force->begin(), force->end());
  if (!a.run.plan.empty()) return plan;
  // Without a plan file there is no unit under test: no limits, and a distance at which the plates suit the sensor.
  plan->name = "simulate";
  plan->limits = {};
  plan->camera = {};
  plan->target.kind = TargetKind::scene;
  return with_suitable_distance(std::move(*plan));
}

int run_simulate(Console& console, SimulateArguments arguments, const Program& program) {
  auto plan = simulation_plan(arguments, program);
  if (!plan) return report_error(console, plan.error());
  auto outcome = simulate_plan(*plan, folder_of(arguments.run, *plan), listener_of(console), program.stop->token());
  console.end_progress();
  if (!outcome) return report_error(console, outcome.error());
  if (console.json()) {
    console.object(curve_json(outcome->curve, outcome->effects, outcome->figures));
  } else {
    print_curve(console, outcome->curve);
    for (const auto& d : outcome->effects.decisions) {
      console.text("  " + std::string(to_string(d.effect)) + ": " +
                   (d.decision == Decision::simulate ? "simulated" : "skipped") + ", " + d.reason);
    }
    print_verdict(console, outcome->verdict);
  }
  return finish(console, *outcome);
}

int run_demo(Console& console, const RunArguments& arguments, const Program& program) {
#ifdef TODBENCH_WITH_ARAVIS
  auto plan = load_plan("demo");
  if (!plan) return report_error(console, plan.error());
  if (program.common.seed_given) plan->seed = program.common.seed;
  EmulationArguments emulation;
  emulation.sensor = plan->simulation.sensor;
  emulation.plates = plan->target.plates;
  emulation.distance_m = plan->target.distance_m;
  emulation.black_body_port = 0;
  emulation.stage_port = 0;
  emulation.seed = plan->seed + 1;  // a camera of its own, not the twin's noise
  console.phase("starting the emulated laboratory");
  auto laboratory = start_laboratory(emulation);
  if (!laboratory) return report_error(console, laboratory.error());
  plan->camera.id = "gige:" + (*laboratory)->camera_address();
  plan->target.black_body = (*laboratory)->black_body_endpoint();
  plan->target.stage = (*laboratory)->stage_endpoint();
  auto outcome = measure_plan(*plan, folder_of(arguments, *plan), listener_of(console), program.stop->token());
  console.end_progress();
  if (!outcome) return report_error(console, outcome.error());
  if (console.json()) {
    console.object({{"measured", curve_json(outcome->curve, {}, outcome->figures)},
                    {"simulated", outcome->twin ? curve_json(*outcome->twin, outcome->effects, {}) : Json()},
                    {"comparison", outcome->comparison ? comparison_json(*outcome->comparison) : Json()},
                    {"verdict", to_string(outcome->verdict.overall)},
                    {"session", outcome->folder.string()}});
  } else {
    if (outcome->comparison) print_comparison(console, *outcome);
    console.text("");
    print_verdict(console, outcome->verdict);
    console.text("report: " + (outcome->folder / "report.html").string());
  }
  return finish(console, *outcome);
#else
  (void)arguments;
  (void)program;
  return report_error(
      console,
      {ErrorCode::not_found, "this build has no camera libraries: the demonstration needs the emulated GigE camera"});
#endif
}

void add_folder_options(CLI::App& command, RunArguments& arguments) {
  command.add_option("--out", arguments.out, "session folder; default: session-TIME-NAME in the current folder");
}

}  // namespace

void add_measure_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("measure", "measures a TOD curve with the camera and target that the plan names");
  auto a = std::make_shared<RunArguments>();
  command->add_option("PLAN.toml", a->plan, "name or file")->required();
  add_folder_options(*command, *a);
  command->add_flag("--force", a->forced, "overwrite the session in an existing folder");
  finish_command(*command, program, [a, &program](Console& console) { return run_measure(console, *a, program); });
}

void add_simulate_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("simulate", "the same with the simulated sensor");
  auto a = std::make_shared<SimulateArguments>();
  command->add_option("PLAN.toml", a->run.plan, "name or file; without it the options below say what to simulate");
  add_folder_options(*command, a->run);
  command->add_option("--sensor", a->sensor, "name or file");
  command->add_option("--observer", a->observer, "name or file");
  command->add_option("--microscan", a->microscan, "samples per detector pitch and axis")->check(CLI::Range(1, 4));
  command->add_option("--delta-t-k", a->delta_t_k, "contrasts in kelvin, separated by commas")->delimiter(',');
  command->add_option("--tolerance-percent", a->tolerance_percent, "what may be wrong in the 75 % acuity")
      ->check(CLI::Range(0.01, 50.0));
  command->add_option("--accuracy", a->accuracy, "draft, normal or reference");
  command->add_option("--skip", a->skip, "effect not to simulate; may be repeated")->delimiter(',');
  auto* force = command->add_option(
      "--force", a->run.force,
      "with the name of an effect: simulate it; alone: overwrite the session in an existing folder");
  force->expected(0, 1)->delimiter(',')->take_all()->trigger_on_parse(false);
  finish_command(*command, program, [a, force, &program](Console& console) {
    std::erase(a->run.force, std::string());
    a->run.forced = force->count() > 0 && a->run.force.size() < force->count();
    if (force->count() > 0 && !a->run.force.empty() && !effect_from(a->run.force.back()) && a->run.plan.empty())
      a->run.forced = true;
    return run_simulate(console, *a, program);
  });
}

void add_demo_command(CLI::App& app, Program& program) {
  auto* command =
      app.add_subcommand("demo", "the whole job on the emulated laboratory: measure, simulate, compare, report");
  auto a = std::make_shared<RunArguments>();
  add_folder_options(*command, *a);
  command->add_flag("--force", a->forced, "overwrite the session in an existing folder");
  finish_command(*command, program, [a, &program](Console& console) { return run_demo(console, *a, program); });
}

}  // namespace todbench
