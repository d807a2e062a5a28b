#include "bench/cli/command_dynamic.h"

#include <fmt/format.h>

#include <memory>

#include "bench/enhance/dynamic_acuity.h"
#include "bench/plan/descriptions.h"
#include "bench/session/json_output.h"
#include "bench/text/text.h"
#include "tod/plate/test_pattern.h"
#include "tod/psychometric/acuity.h"

namespace todbench {
namespace {

struct DynamicArguments {
  std::string sensor = "sc2000", observer = "hvs-1", accuracy = "normal", package;
  double delta_t_k = 16.9;
  std::vector<double> speeds_mrad_s, sizes_pitch;
  int passes = 48, frames = 8;
  double time_constant_ms = -1;
};

Json dynamic_json(const std::vector<DynamicAcuity>& found, const SensorSpec& sensor, const DynamicArguments& a,
                  std::uint64_t seed) {
  Json speeds = Json::array();
  for (const DynamicAcuity& at : found) {
    Json points = Json::array();
    for (const DynamicPoint& point : at.points) {
      points.push_back({{"observer", to_string(point.observer)},
                        {"verdict", to_string(point.fit.verdict)},
                        {"s75_mrad", json_number(point.fit.threshold)},
                        {"s75_ci95_mrad", json_interval(point.fit.ci95)},
                        {"acuity_per_mrad", json_number(acuity_per_mrad(point.fit))},
                        {"ratio_to_static", json_number(point.ratio)},
                        {"ratio_to_static_ci95", json_interval(point.ratio_ci95)}});
    }
    speeds.push_back({{"speed_mrad_s", at.speed_mrad_s},
                      {"speed_px_per_frame", at.speed_px},
                      {"smear_px", at.smear_px},
                      {"points", points}});
  }
  return {{"sensor", sensor.name},
          {"observer", a.observer},
          {"delta_t_k", a.delta_t_k},
          {"time_constant_ms", sensor.time_constant_ms},
          {"frame_rate_hz", sensor.frame_rate_hz},
          {"frames", a.frames},
          {"passes", a.passes},
          {"direction", "x, both ways in turn"},
          {"package", a.package.empty() ? Json() : Json(a.package)},
          {"lag", a.package.empty() ? "removed" : "that of the time constant removed, that of the package not"},
          {"internal_noise", "per decision"},
          {"seed", seed},
          {"speeds", speeds}};
}

int run_dynamic(Console& console, const DynamicArguments& a, const Program& program) {
  auto sensor = load_sensor(a.sensor);
  if (!sensor) return report_error(console, sensor.error());
  if (a.time_constant_ms >= 0) sensor->time_constant_ms = a.time_constant_ms;
  const auto spec = load_observer(a.observer);
  if (!spec) return report_error(console, spec.error());
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
    options.stages = [&package] { return made_stages(package, {}); };
  }
  console.phase("simulating " + sensor->name + " before a moving target");
  const auto found = dynamic_acuity(*sensor, observer, std::move(options));
  if (!found) return report_error(console, found.error());
  if (console.json()) console.object(dynamic_json(*found, *sensor, a, program.common.seed));
  std::vector<TableRow> rows;
  for (const DynamicAcuity& at : *found) {
    for (const DynamicPoint& point : at.points) {
      rows.push_back({fmt::format("{:g}", at.speed_mrad_s), fmt::format("{:.3g}", at.speed_px),
                      std::string(to_string(point.observer)), fixed(acuity_per_mrad(point.fit), 3),
                      range(acuity_interval(point.fit.ci95), 3), fixed(point.ratio, 3), range(point.ratio_ci95, 3)});
    }
  }
  console.table({"speed (mrad/s)", "px/frame", "observer", "acuity (1/mrad)", "95 %", "to static", "95 %"}, rows);
  return 0;
}

}  // namespace

void add_dynamic_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("dynamic", "acuity before a target that moves, beside one that rests");
  auto a = std::make_shared<DynamicArguments>();
  command->add_option("--sensor", a->sensor, "name or file")->capture_default_str();
  command->add_option("--observer", a->observer, "name or file")->capture_default_str();
  command->add_option("--delta-t-k", a->delta_t_k, "contrast in kelvin")
      ->capture_default_str()
      ->check(number_in(-1000, 1000));
  command->add_option("--speeds-mrad-s", a->speeds_mrad_s, "speeds along x; 0 is added")
      ->required()
      ->expected(1, 32)
      ->check(number_in(0, 1e6));
  command->add_option("--frames", a->frames, "of a pass")->capture_default_str()->check(whole_number(1, 64));
  command->add_option("--passes", a->passes, "to the right and to the left in turn")
      ->capture_default_str()
      ->check(whole_number(2, 10000));
  command
      ->add_option("--sizes-pitch", a->sizes_pitch, "sizes in detector pitches in place of those round the threshold")
      ->expected(2, 32)
      ->check(number_in(0.1, 40));
  command->add_option("--time-constant-ms", a->time_constant_ms, "in place of the sensor's")->check(number_in(0, 1000));
  command->add_option("--package", a->package, "file of stages behind the camera; their lag is not taken out");
  command->add_option("--accuracy", a->accuracy, "of the simulation")
      ->capture_default_str()
      ->check(CLI::IsMember({"draft", "normal"}));
  finish_command(*command, program, [a, &program](Console& console) { return run_dynamic(console, *a, program); });
}

}  // namespace todbench
