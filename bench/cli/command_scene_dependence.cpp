#include "bench/cli/command_scene_dependence.h"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <utility>

#include "bench/cli/seeded_plan.h"
#include "bench/enhance/scene_dependence.h"
#include "bench/session/json_output.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

struct SceneDependenceArguments {
  std::string plan, package;
  double bar_k = 40;
  int settle_frames = -1;
  SceneDependenceOptions options;
};

Json scene_dependence_json(const SceneDependence& found) {
  Json sizes = Json::array();
  for (const SizeDependence& size : found.sizes) {
    sizes.push_back({{"size_mm", size.size_mm},
                     {"size_px", size.size_px},
                     {"triangles", size.triangles},
                     {"ratio", size.ratio},
                     {"ratio_ci95", json_interval(size.ci95)}});
  }
  return {{"camera", found.camera},
          {"package", found.package.empty() ? Json() : Json(found.package)},
          {"plate", found.plate},
          {"set_delta_t_k", found.set_delta_t_k},
          {"cycles", found.cycles},
          {"tolerance_percent", found.tolerance_percent},
          {"verdict", to_string(found.verdict)},
          {"sizes", sizes},
          {"notes", found.notes}};
}

int run_scene_dependence(Console& console, const SceneDependenceArguments& a, const Program& program) {
  const auto loaded = with_seed(read_plan(a.plan), program.common);
  if (!loaded) return report_error(console, loaded.error());
  std::optional<EnhancementPackage> package;
  if (!a.package.empty()) {
    auto read = read_package(a.package);
    if (!read) return report_error(console, read.error());
    package = *std::move(read);
  }
  SceneDependenceOptions options = a.options;
  // A gain control of a camera takes its time; the simulated one knows its own.
  constexpr int frames_of_a_gain_control = 100;
  const bool simulated = loaded->plan().camera.id.empty();
  options.settle_frames = a.settle_frames >= 0 ? a.settle_frames : simulated ? 0 : frames_of_a_gain_control;
  console.phase("measuring with a hot bar out of the field and in it");
  const auto found =
      plan_scene_dependence(*loaded, package ? &*package : nullptr, a.bar_k, options, {}, program.stop->token());
  if (!found) return report_error(console, found.error());
  if (console.json()) console.object(scene_dependence_json(*found));
  std::vector<TableRow> rows;
  for (const SizeDependence& size : found->sizes)
    rows.push_back({fmt::format("{:g}", size.size_mm), fmt::format("{:.2f}", size.size_px),
                    std::to_string(size.triangles), fixed(size.ratio, 4), range(size.ci95, 4)});
  console.table({"size (mm)", "px", "triangles", "bar in / out", "95 % together"}, rows);
  for (const std::string& note : found->notes) console.note(note);
  console.text(fmt::format("response and scene: {} (tolerance {:g} %, {} cycles)", to_string(found->verdict),
                           found->tolerance_percent, found->cycles));
  if (found->verdict == SceneDependenceVerdict::depends) return 1;
  return found->verdict == SceneDependenceVerdict::independent ? 0 : 3;
}

}  // namespace

void add_scene_dependence_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("scene-dependence",
                                     "how far a hot bar in the field changes a camera's response to the triangles");
  auto a = std::make_shared<SceneDependenceArguments>();
  command
      ->add_option("PLAN", a->plan,
                   "name or file: its camera, before which the operator moves the bar, or its simulated sensor")
      ->required();
  command->add_option("--package", a->package, "file of stages behind the simulated sensor");
  command->add_option("--bar-k", a->bar_k, "of the simulated bar above the surround")
      ->capture_default_str()
      ->check(number_in(0.1, 1000));
  command->add_option("--cycles", a->options.cycles, "each out, in, in, out")
      ->capture_default_str()
      ->check(whole_number(3, 1000));
  command->add_option("--frames", a->options.frames, "averaged each time")
      ->capture_default_str()
      ->check(whole_number(1, 10000));
  command
      ->add_option("--settle-frames", a->settle_frames,
                   "left out after the bar has moved; default: 100 of a camera, of a package what it remembers")
      ->check(whole_number(0, 100000));
  command->add_option("--tolerance-percent", a->options.tolerance_percent, "of the response")
      ->capture_default_str()
      ->check(number_in(0.001, 100));
  finish_command(*command, program,
                 [a, &program](Console& console) { return run_scene_dependence(console, *a, program); });
}

}  // namespace todbench
