// SPDX-License-Identifier: GPL-3.0-or-later
// todbench measure, todbench simulate, todbench replay, todbench demo
#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>

#include "acquisition/base/try.h"
#include "bench/cli/commands.h"
#include "bench/cli/effect_decisions.h"
#include "bench/cli/key_options.h"
#include "bench/cli/run_display.h"
#include "bench/cli/run_results.h"
#include "bench/cli/session_argument.h"
#include "bench/cli/simulation_plan.h"
#include "bench/cli/watch.h"
#include "bench/devices/emulation.h"
#include "bench/devices/terminal_operator.h"
#include "bench/plan/resources.h"
#include "bench/run/experiment.h"
#include "bench/run/replay.h"
#include "bench/run/report_data.h"
#include "bench/run/resumed_run.h"
#include "bench/serve/live_run.h"
#include "bench/session/fit_record.h"
#include "bench/session/json_output.h"
#include "bench/session/provenance.h"
#include "bench/session/uncertainty_record.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

struct RunArguments {
  std::string plan;
  std::string out;
  bool overwrite = false;
  KeyOverrides keys{};
};

/// The page to watch a run remotely; without an address there is none.
struct ServeArguments {
  std::string address;
  bool network = false;
};

struct MeasureArguments {
  RunArguments run{};
  ServeArguments serve{};
  std::string resumed{};  ///< session folder; empty: a new run
  Opening opening{};
  bool run_modules = false;
};

struct DemoArguments {
  MeasureArguments measure{};
  std::string camera = emulated_cameras().front();
  bool full = false;
};

struct SimulateArguments {
  RunArguments run;
  SimulationOverrides overrides;
  bool why = false;
};

ExperimentOptions folder_of(const RunArguments& arguments, const std::string& name) {
  if (arguments.out.empty()) return {.folder = session_folder_name(name), .existing = ExistingFolder::number};
  return {.folder = arguments.out,
          .existing = arguments.overwrite ? ExistingFolder::overwrite : ExistingFolder::refuse};
}

/// Returns the plan with the overrides of the command line.
Result<Plan> with_options(Plan plan, const RunArguments& arguments, const Program& program) {
  if (program.common.seed_given) plan.seed = program.common.seed;
  TODBENCH_TRY_VOID(apply(arguments.keys, plan));
  return plan;
}

using Measure = std::function<Result<ExperimentOutcome>(const ExperimentOptions&, const ExperimentListener&)>;

/// Asks the operator at the terminal and shows the request on the page too.
AskOperator asking_on_page_too(LiveRun& live) {
  const AskOperator at_terminal = ask_at_terminal();
  return [&live, at_terminal](const OperatorRequest& request, const std::stop_token& stop) {
    std::string steps;
    for (const OperatorStep& step : request.steps) steps += (steps.empty() ? "" : "\n") + sentence(step);
    live.ask(steps);
    auto answer = at_terminal(request, stop);
    live.ask("");
    return answer;
  };
}

/// Measures with display on the terminal, and on the page if requested.
Result<ExperimentOutcome> measure_shown(Console& console, const Plan& plan, ExperimentOptions options,
                                        const ServeArguments& serve, const Measure& measure) {
  if (serve.address.empty()) {
    RunDisplay shown(console, plan);
    return measure(options, shown.listener());
  }
  const auto address = serve_address(serve.address, serve.network ? Reach::network : Reach::this_computer);
  if (!address) return fail("--serve", address.error());
  const auto server = LiveServer::start(*address);
  if (!server) return fail("--serve", server.error());
  console.warning("live page: " + (*server)->url());
  RunDisplay shown(console, plan, RunDisplay::Curve::of_others_too);
  LiveRun live(**server, *shown.curve(), plan);
  options.host.ask_operator = asking_on_page_too(live);
  auto outcome = measure(options, live.listening(shown.listener()));
  const bool whole = outcome && !outcome->ended_by;
  const auto reason = whole     ? std::nullopt
                      : outcome ? std::optional(outcome->ended_by->message)
                                : std::optional(outcome.error().message);
  live.end(whole     ? "the run is finished"
           : outcome ? "the trials so far are in the session"
                     : "the run has no result",
           whole ? std::optional(std::string(to_string(outcome->verdict.decision))) : std::nullopt, reason);
  (*server)->wait_until_seen(std::chrono::seconds(3));
  return outcome;
}

int run_measure(Console& console, const MeasureArguments& asked, const Program& program) {
  const RunArguments& arguments = asked.run;
  auto loaded = read_camera_plan(arguments.plan);
  if (!loaded) return report_error(console, loaded.error());
  const auto plan = with_options(loaded->plan(), arguments, program);
  if (!plan) return report_error(console, plan.error());
  loaded = loaded->with(*plan);
  if (!loaded) return report_error(console, in_terms_of_options(loaded.error()));
  auto outcome = measure_shown(console, *plan, folder_of(arguments, plan->name), asked.serve,
                               [&](const ExperimentOptions& options, const ExperimentListener& listener) {
                                 return measure_plan(*loaded, options, listener, program.stop->token());
                               });
  console.end_progress();
  if (!outcome) return report_error(console, outcome.error());
  return show_run(console, *outcome);
}

int run_resume(Console& console, const MeasureArguments& asked, const Program& program) {
  if (!asked.run.keys.given.empty() || program.common.seed_given)
    return report_error(
        console, {ErrorCode::invalid_input, "--resume uses the plan of the session, so no option may change the plan"});
  auto run =
      open_interrupted_run(asked.resumed, nullptr, asked.opening, asked.run_modules ? RunModules::yes : RunModules::no);
  if (!run) return report_error(console, run.error());
  auto outcome = measure_shown(console, run->session.plan, folder_of(asked.run, run->session.plan.name + "-resumed"),
                               asked.serve, [&](const ExperimentOptions& options, const ExperimentListener& listener) {
                                 return resume_session(*std::move(run), options, listener, program.stop->token());
                               });
  console.end_progress();
  if (!outcome) return report_error(console, outcome.error());
  return show_run(console, *outcome);
}

int run_simulate(Console& console, SimulateArguments arguments, const Program& program) {
  if (program.common.seed_given) arguments.overrides.seed = program.common.seed;
  const auto loaded = simulation_plan(arguments.overrides, program.stop->token());
  if (!loaded) return report_error(console, loaded.error());
  RunDisplay shown(console, loaded->plan());
  auto outcome =
      simulate_plan(*loaded, folder_of(arguments.run, loaded->plan().name), shown.listener(), program.stop->token());
  console.end_progress();
  if (!outcome) return report_error(console, outcome.error());
  return show_run(console, *outcome, {.effects = true, .why = arguments.why});
}

int run_demo(Console& console, const DemoArguments& asked, const Program& program) {
#ifdef TODBENCH_WITH_ARAVIS
  const RunArguments& arguments = asked.measure.run;
  const std::string& camera = asked.camera;
  enter_emulation(camera);
  const auto shipped = demonstration_plan(asked.full ? DemonstrationLength::full : DemonstrationLength::quick);
  if (!shipped) return report_error(console, shipped.error());
  auto plan = with_options(*shipped, arguments, program);
  if (!plan) return report_error(console, plan.error());
  EmulationArguments emulation = emulation_for(*plan);
  emulation.camera = camera;
  console.phase("starting the emulated laboratory");
  auto laboratory = start_laboratory(emulation);
  if (!laboratory) return report_error(console, laboratory.error());
  *plan = with_laboratory(*plan, **laboratory);
  if (camera != "gige") plan->unit = "emulated " + camera + " camera";
  auto outcome = measure_shown(console, *plan, folder_of(arguments, plan->name), asked.measure.serve,
                               [&](const ExperimentOptions& options, const ExperimentListener& listener) {
                                 return measure_plan(*plan, options, listener, program.stop->token());
                               });
  console.end_progress();
  if (!outcome) return report_error(console, outcome.error());
  if (console.json()) {
    Json json{{"measured", curve_json(outcome->curve, {}, outcome->figures)},
              {"simulated", outcome->twin ? curve_json(*outcome->twin, outcome->effects, {}) : Json()},
              {"comparison", outcome->comparison ? comparison_json(*outcome->comparison) : Json()}};
    if (outcome->uncertainty) add_uncertainty(json["measured"], *outcome->uncertainty);
    add_verdict(json, outcome->verdict);
    json["bill"] = bill_json(bill_of(*outcome));
    json["session"] = outcome->folder.string();
    console.object(json);
  } else {
    print_run(console, *outcome, {.curve = false});
    console.text("report: " + (outcome->folder / "report.html").string());
  }
  return finish_run(console, *outcome);
#else
  (void)asked;
  (void)program;
  return report_error(
      console, {ErrorCode::not_found,
                "this build has no camera libraries; the demonstration needs them for the emulated GigE camera"});
#endif
}

bool names_a_plan(const std::string& word) {
  const auto names = resource_names(ResourceKind::plan);
  return is_file_reference(word) || std::find(names.begin(), names.end(), word) != names.end();
}

void add_folder_options(CLI::App& command, RunArguments& arguments) {
  command.add_option("--out", arguments.out, "session folder; default: session-TIME-NAME in the current folder");
}

void add_serve_options(CLI::App& command, ServeArguments& serve) {
  command.add_option("--serve", serve.address,
                     "shows the run in a browser: HOST:PORT of the page; the full address is printed");
  command.add_flag("--serve-network", serve.network, "allows --serve to use an address that other computers can reach");
}

struct ReplayArguments {
  RunArguments run{};
  std::string session;
  Opening opening{};
  bool run_modules = false;
};

/// The likely reason of different answers.
std::string why_different(const std::vector<std::string>& accepted_changes) {
  if (accepted_changes.empty()) return "it was recorded by another version of the program, or the program has a defect";
  std::string files;
  for (const std::string& file : accepted_changes) files += (files.empty() ? "" : ", ") + file;
  return "files of the session were changed, which --accept-changed accepted: " + files;
}

int run_replay(Console& console, const ReplayArguments& asked, const Program& program) {
  const auto& [arguments, session, opening, run_modules] = asked;
  const ExperimentOptions options = folder_of(arguments, session_name(session) + "-replay");
  auto outcome = replay_session(session, options, listener_of(console), program.stop->token(), opening,
                                run_modules ? RunModules::yes : RunModules::no);
  console.end_progress();
  if (!outcome) return report_error(console, outcome.error());
  const auto said = [](const std::optional<bool>& same) { return same ? (*same ? "the same" : "DIFFERENT") : "none"; };
  if (console.json()) {
    Json json = curve_json(outcome->run.curve, outcome->run.effects, outcome->run.figures);
    add_verdict(json, outcome->run.verdict);
    json["same_trials"] = outcome->same_trials;
    json["same_fits"] = outcome->same_fits ? Json(*outcome->same_fits) : Json();
    json["session"] = outcome->run.folder.string();
    add_accepted_changes(json, opening, outcome->accepted_changes);
    console.object(json);
  } else {
    print_curve(console, outcome->run.curve);
    console.text("");
    for (const std::string& file : outcome->accepted_changes)
      console.text("changed, removed or added after the session ended (accepted): " + file);
    console.text("trials: " + std::string(said(outcome->same_trials)) + "; fits: " + said(outcome->same_fits));
  }
  if (!outcome->same_trials || !outcome->same_fits.value_or(true)) {
    console.error("the answers of the replay differ from those of the session: " +
                  why_different(outcome->accepted_changes));
    return exit_code(VerdictKind::fail);
  }
  return finish_run(console, outcome->run);
}

}  // namespace

void add_replay_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand(
      "replay",
      "evaluates the recorded frames of a session again in a new session; the answers are identical bit for bit");
  auto a = std::make_shared<ReplayArguments>();
  command->add_option("DIR", a->session, "session folder with recorded frames")->required();
  add_folder_options(*command, a->run);
  command->add_flag("--force", a->run.overwrite, "overwrites the session in an existing folder");
  command->add_flag("--run-modules", a->run_modules, "starts the programs that the session names in [[module]]");
  add_accept_changed(*command, a->opening.accept_changed);
  finish_command(*command, program, [a, &program](Console& console) { return run_replay(console, *a, program); });
}

void add_measure_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("measure", "measures a TOD curve with the camera and target that the plan names");
  auto a = std::make_shared<MeasureArguments>();
  auto* plan = command->add_option("PLAN.toml", a->run.plan, "plan: name or file");
  auto watched = std::make_shared<std::string>();
  command
      ->add_option(
          "--watch", *watched,
          "shows the curve of a session that another process is measuring, until it ends; measures nothing itself")
      ->excludes(plan);
  command
      ->add_option("--resume", a->resumed,
                   "goes on with an interrupted session with recorded frames: same plan, same camera, a new session")
      ->excludes(plan);
  command->add_flag("--run-modules", a->run_modules,
                    "with --resume: starts the programs that the session names in [[module]]");
  add_accept_changed(*command, a->opening.accept_changed);
  add_folder_options(*command, a->run);
  command->add_flag("--force", a->run.overwrite, "overwrites the session in an existing folder");
  add_serve_options(*command, a->serve);
  add_key_options(*command, OptionOf::measurements, a->run.keys);
  finish_command(*command, program, [a, plan, watched, &program](Console& console) {
    if (!watched->empty()) return watch_session(console, *watched, program.stop->token());
    if (!a->resumed.empty()) return run_resume(console, *a, program);
    if (plan->count() == 0)
      return report_error(
          console, {ErrorCode::invalid_input, "measure: PLAN.toml is required (or --watch DIR, or --resume DIR)"});
    return run_measure(console, *a, program);
  });
}

void add_simulate_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand(
      "simulate", "simulates a TOD curve: the same test as measure, with a simulated sensor in place of the camera");
  auto a = std::make_shared<SimulateArguments>();
  SimulationOverrides& o = a->overrides;
  command->add_option(
      "PLAN.toml", o.plan,
      "plan: name or file; without a plan the options define the simulation, at a distance that suits the sensor");
  add_folder_options(*command, a->run);
  command->add_flag("--why", a->why, why_text);
  // --force means an existing folder here as well.
  add_key_options(*command, OptionOf::simulations, o.keys, "simulation.force");
  auto forced = std::make_shared<std::vector<std::string>>();
  auto* force = command->add_option(
      "--force", *forced,
      "with effects: simulates them even if they are neutral; alone: overwrites the session in an existing folder");
  force->expected(0, 1)->delimiter(',')->take_all()->trigger_on_parse(false);
  finish_command(*command, program, [a, force, forced, &program](Console& console) {
    SimulationOverrides& given = a->overrides;
    // The bare flag takes the next word for an effect; a word that names a plan is the plan.
    std::erase(*forced, std::string());
    a->run.overwrite = forced->size() < force->count();
    if (given.plan.empty() && !forced->empty() && names_a_plan(forced->back())) {
      given.plan = forced->back();
      forced->pop_back();
      a->run.overwrite = true;
    }
    if (!forced->empty()) given.keys.given["simulation.force"] = *forced;
    return run_simulate(console, std::move(*a), program);
  });
}

void add_demo_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand(
      "demo",
      "runs the whole test on the emulated laboratory in about 40 s: measures, simulates, compares and reports");
  auto a = std::make_shared<DemoArguments>();
  RunArguments& run = a->measure.run;
  add_folder_options(*command, run);
  command->add_flag("--force", run.overwrite, "overwrites the session in an existing folder");
  add_serve_options(*command, a->measure.serve);
  add_key_options(*command, OptionOf::measurements, run.keys);
  command->add_flag(
      "--full", a->full,
      "runs the whole plan 'acceptance' with all physical measures and their limits; takes about 30 s longer");
  command->add_option("--camera", a->camera, "interface of the emulated camera")
      ->check(CLI::IsMember(emulated_cameras()))
      ->capture_default_str();
  finish_command(*command, program, [a, &program](Console& console) { return run_demo(console, *a, program); });
}

}  // namespace todbench
