// SPDX-License-Identifier: GPL-3.0-or-later
// todbench scene-dependence
#include "bench/cli/commands.h"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <utility>

#include "bench/cli/run_display.h"
#include "bench/cli/seeded_plan.h"
#include "bench/judgement/verdict_record.h"
#include "bench/scene_dependence/scene_dependence_session.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

struct SceneDependenceArguments {
  std::string plan, package, out;
  bool overwrite = false;
  double bar_k = 40;
  int settle_frames = -1;
  SceneDependenceOptions options;
};

int run_scene_dependence(Console& console, const SceneDependenceArguments& a, const Program& program) {
  const auto loaded = with_seed(read_plan(a.plan), program.common);
  if (!loaded) return report_error(console, loaded.error());
  SceneDependenceTask task{.bar_k = a.bar_k, .options = a.options};
  if (!a.package.empty()) {
    auto read = read_package(a.package);
    if (!read) return report_error(console, read.error());
    task.package = *std::move(read);
  }
  // The gain control of a real camera is slow; the settling of the simulated one is known.
  constexpr int frames_of_a_gain_control = 100;
  const Plan& plan = loaded->plan();
  task.options.settle_frames = a.settle_frames >= 0     ? a.settle_frames
                               : plan.camera.id.empty() ? 0
                                                        : frames_of_a_gain_control;
  const ExperimentOptions options{
      .folder = a.out.empty() ? std::filesystem::path(session_folder_name(plan.name)) : std::filesystem::path(a.out),
      .existing = a.overwrite     ? ExistingFolder::overwrite
                  : a.out.empty() ? ExistingFolder::number
                                  : ExistingFolder::refuse};
  const auto session =
      measure_scene_dependence_session(*loaded, task, options, listener_of(console), program.stop->token());
  if (!session) return report_error(console, session.error());
  const SceneDependence* const found = &session->found;
  if (console.json()) {
    Json json = scene_dependence_json(*found, task);
    json["judgement"] = verdict_json(session->verdict);
    json["session"] = session->folder.string();
    console.object(json);
  }
  std::vector<TableRow> rows;
  for (const SizeDependence& size : found->sizes)
    rows.push_back({fmt::format("{:g}", size.size_mm), fmt::format("{:.2f}", size.size_px),
                    std::to_string(size.triangles), fixed(size.ratio, 4), range(size.ci95, 4)});
  console.table({"size [mm]", "size [px]", "triangles", "response bar in / out", "simultaneous 95 %"}, rows);
  console.text(fmt::format("dependence of the response on the scene: {} (tolerance {:g} %, {} cycles)",
                           to_string(found->verdict), found->tolerance_percent, found->cycles));
  console.text("report: " + (session->folder / "report.html").string());
  if (session->ended_by) return report_error(console, *session->ended_by);
  return exit_code(session->verdict.decision);
}

}  // namespace

void add_scene_dependence_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand(
      "scene-dependence", "measures how much a hot bar in the field changes the response of a camera to the triangles");
  auto a = std::make_shared<SceneDependenceArguments>();
  command
      ->add_option("PLAN", a->plan,
                   "plan: name or file; the operator moves the bar in front of its camera; without a camera the sensor "
                   "is simulated")
      ->required();
  command->add_option("--package", a->package, "package of processing steps after the simulated sensor");
  command->add_option("--out", a->out, "session folder; default: session-TIME-NAME in the current folder");
  command->add_flag("--force", a->overwrite, "overwrites the session in an existing folder");
  command->add_option("--bar-k", a->bar_k, "temperature of the simulated bar above the surround in K")
      ->capture_default_str()
      ->check(number_in(0.1, 1000, "k"));
  command->add_option("--cycles", a->options.cycles, "number of cycles; in each the bar is out, in, in, out")
      ->capture_default_str()
      ->check(whole_number(3, 1000));
  command->add_option("--frames", a->options.frames, "frames averaged for each position of the bar")
      ->capture_default_str()
      ->check(whole_number(1, 10000));
  command
      ->add_option("--settle-frames", a->settle_frames,
                   "frames skipped after each movement of the bar; default: 100 for a camera, the memory of the "
                   "package for a simulation")
      ->check(whole_number(0, 100000));
  command
      ->add_option("--tolerance-percent", a->options.tolerance_percent,
                   "largest change of the response, in percent, that counts as independent of the scene")
      ->capture_default_str()
      ->check(number_in(0.001, 100));
  finish_command(*command, program,
                 [a, &program](Console& console) { return run_scene_dependence(console, *a, program); });
}

}  // namespace todbench
