// SPDX-License-Identifier: GPL-3.0-or-later
// todbench doctor
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/cli/commands.h"
#include "bench/cli/plan_decisions.h"
#include "bench/cli/simulation_plan.h"
#include "bench/devices/devices.h"
#include "bench/doctor/doctor.h"
#include "bench/twin/acuity_limits.h"

namespace todbench {
namespace {

struct DoctorArguments {
  std::string root = "/", folder = ".", plan;
  DoctorDemand demand;
};

/// What limits the acuity of the plan's simulated sensor at each contrast, and the proposed viewing.
struct PlanLimits {
  std::vector<AcuityLimits> acuity;
  std::optional<ViewingProposal> viewing;
  std::optional<ViewedDisplay> display;
};
Result<PlanLimits> limits_of_plan(const std::string& file, const std::stop_token& stop) {
  const auto loaded = simulation_plan({.plan = file, .seed = {}, .keys = {}}, stop);
  if (!loaded) return tl::unexpected(loaded.error());
  EffectPlanner planner;
  TODBENCH_TRY(const auto inputs, experiment_inputs(*loaded, planner));
  const Plan& plan = loaded->plan();
  TODBENCH_TRY(auto acuity, acuity_limits(plan, inputs, plan.target.delta_t_k, stop));
  TODBENCH_TRY(const auto viewing, viewing_of(plan.target.delta_t_k, inputs, stop));
  return PlanLimits{std::move(acuity), viewing, inputs.observer.display};
}

/// A warning if a larger picture would gain more acuity than the error of the estimate.
DoctorCheck check_viewing(const ViewingProposal& viewing, const ViewedDisplay& display) {
  return {.name = "viewing",
          .finding = viewing.stated_cost_percent > 2 * viewing_cost_percent ? Finding::warning : Finding::ok,
          .found = in_words(viewing, display),
          .explanation =
              "The picture appears so small to the eye that the acuity is lower than that of the camera: enlarge the "
              "picture or reduce the viewing distance.",
          .command = {}};
}

/// A warning where display, eye or light limit the acuity most: then the test is not one of the camera.
DoctorCheck check_acuity(const AcuityLimits& limits) {
  const bool camera = limits.costs.empty() || limits.costs.front().factor == LimitingFactor::sampling ||
                      limits.costs.front().factor == LimitingFactor::sensor_noise;
  return {.name = "acuity",
          .finding = camera ? Finding::ok : Finding::warning,
          .found = in_words(limits),
          .explanation =
              "Display, eye or light should not limit a test of a camera: a larger zoom, a shorter distance "
              "or more light lets the camera limit it.",
          .command = {}};
}

/// Known faults of the library behind GigE Vision and USB3 Vision cameras.
DoctorCheck check_camera_library(const CameraLibrary& library) {
  DoctorCheck check{.name = "aravis", .finding = Finding::ok, .found = library.version};
  if (library.faults.empty()) return check;
  check.finding = Finding::warning;
  check.found += fmt::format(", {} known faults", library.faults.size());
  check.explanation = "Later versions of Aravis correct these faults:";
  for (const auto& fault : library.faults) check.explanation += " " + fault + ".";
  return check;
}

/// Returns 0 if no problem prevents a run, otherwise 1.
int run_doctor(Console& console, const DoctorArguments& arguments, const Program& program) {
  SystemFacts facts = live_facts(arguments.folder);
  // The firewall rules of this system do not apply to another root.
  if (arguments.root != "/") facts.firewall_rules.reset();
  auto checks = examine(arguments.root, facts, arguments.demand);
  if (const auto library = camera_library()) checks.push_back(check_camera_library(*library));
  PlanLimits limits;
  if (!arguments.plan.empty()) {
    auto found = limits_of_plan(arguments.plan, program.stop->token());
    if (!found) return report_error(console, found.error());
    limits = *std::move(found);
    for (const AcuityLimits& at : limits.acuity) checks.push_back(check_acuity(at));
    if (limits.viewing) checks.push_back(check_viewing(*limits.viewing, *limits.display));
  }
  const bool trouble =
      std::any_of(checks.begin(), checks.end(), [](const auto& c) { return c.finding == Finding::problem; });
  if (console.json()) {
    Json list = Json::array();
    for (const auto& c : checks) {
      list.push_back({{"name", c.name},
                      {"finding", to_string(c.finding)},
                      {"found", c.found},
                      {"explanation", c.explanation},
                      {"command", c.command.empty() ? Json() : Json(c.command)}});
    }
    Json json{{"checks", list}, {"verdict", trouble ? "problem" : "ok"}};
    if (!arguments.plan.empty()) json["acuity_limits"] = acuity_limits_json(limits.acuity);
    if (limits.viewing) json["viewing_proposal"] = viewing_json(*limits.viewing);
    console.object(json);
    return trouble ? 1 : 0;
  }
  std::vector<TableRow> rows;
  for (const auto& c : checks) rows.push_back({c.name, std::string(to_string(c.finding)), c.found});
  console.table({"check", "finding", "found"}, rows);
  for (const auto& c : checks) {
    if (c.finding == Finding::ok) continue;
    console.text("");
    console.text(c.name + ": " + c.explanation);
    if (!c.command.empty()) console.text("  repair with: " + c.command);
  }
  return trouble ? 1 : 0;
}

}  // namespace

void add_doctor_command(CLI::App& app, Program& program) {
  auto* command =
      app.add_subcommand("doctor", "checks the computer for common faults and prints the command that repairs each");
  auto a = std::make_shared<DoctorArguments>();
  command->add_option("--folder", a->folder, "folder in which sessions will be written")
      ->check(CLI::ExistingDirectory)
      ->capture_default_str();
  command->add_option("--frame-bytes", a->demand.frame_bytes, "size of one frame in bytes")
      ->check(whole_number(1, 1'000'000'000))
      ->capture_default_str();
  command->add_option("--frame-rate-hz", a->demand.frame_rate_hz, "frame rate of the camera in Hz")
      ->check(number_in(0.1, 10000, "hz"))
      ->capture_default_str();
  command
      ->add_option("--packet-bytes", a->demand.packet_bytes,
                   "size of a GigE Vision packet in bytes, with its IP and UDP headers")
      ->check(whole_number(576, 65535))
      ->capture_default_str();
  command
      ->add_option("--recording-minutes", a->demand.recording_minutes,
                   "duration of the recording to be stored on disk, in minutes")
      ->check(number_in(0, 100000))
      ->capture_default_str();
  command->add_option("--root", a->root, "reads the system files below this folder")
      ->check(CLI::ExistingDirectory)
      ->capture_default_str();
  command->add_option("--plan", a->plan, "also states what limits the acuity at each contrast of this plan");
  finish_command(*command, program, [a, &program](Console& console) { return run_doctor(console, *a, program); });
}

}  // namespace todbench
