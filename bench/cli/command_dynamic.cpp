#include "bench/cli/command_dynamic.h"

#include <fmt/format.h>

#include <memory>
#include <utility>

#include "bench/enhance/dynamic_measurement.h"
#include "bench/plan/descriptions.h"
#include "bench/session/json_output.h"
#include "bench/text/text.h"
#include "tod/plate/test_pattern.h"
#include "tod/psychometric/acuity.h"

namespace todbench {
namespace {

struct DynamicArguments {
  std::string plan, sensor = "sc2000", observer = "hvs-1", accuracy = "normal", package;
  double delta_t_k = 16.9;
  std::vector<double> speeds_mrad_s, sizes_pitch;
  int passes = 48, frames = 8;
  double time_constant_ms = -1, exposure_ms = -1, row_time_us = -1;
};

Json speeds_json(const std::vector<DynamicAcuity>& found) {
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
                      {"exposure_px", at.exposure_px},
                      {"lag_px", at.lag_px},
                      {"points", points}});
  }
  return speeds;
}

void add_rows(std::vector<TableRow>& rows, const std::vector<DynamicAcuity>& found, const TableRow& first) {
  for (const DynamicAcuity& at : found) {
    for (const DynamicPoint& point : at.points) {
      TableRow row = first;
      const TableRow cells{fmt::format("{:g}", at.speed_mrad_s),
                           fmt::format("{:.3g}", at.speed_px),
                           std::string(to_string(point.observer)),
                           fixed(acuity_per_mrad(point.fit), 3),
                           range(acuity_interval(point.fit.ci95), 3),
                           fixed(point.ratio, 3),
                           range(point.ratio_ci95, 3)};
      row.insert(row.end(), cells.begin(), cells.end());
      rows.push_back(std::move(row));
    }
  }
}

Json passes_json(const std::vector<MovingPassRecord>& passes) {
  Json all = Json::array();
  for (const MovingPassRecord& pass : passes) {
    all.push_back({{"pass", pass.pass},
                   {"pair", pass.pair},
                   {"plate", pass.plate},
                   {"mounting", to_string(pass.mounting)},
                   {"set_delta_t_k", pass.set_delta_t_k},
                   {"delta_t_k", pass.delta_t_k},
                   {"speed_mrad_s", pass.speed_mrad_s},
                   {"direction", pass.along_x > 0 ? "right" : "left"},
                   {"said_px_s", pass.said_px_s},
                   {"measured_px_s", pass.measured_px_s},
                   {"residual_px", pass.residual_px},
                   {"lag_ms", pass.lag_s ? Json(1e3 * *pass.lag_s) : Json()},
                   {"triangles_left_out", pass.left_out},
                   {"dropped", pass.dropped.empty() ? Json() : Json(pass.dropped)}});
  }
  return all;
}

Json measured_json(const DynamicMeasurement& found, const Plan& plan) {
  Json contrasts = Json::array();
  for (const DynamicContrast& at : found.contrasts)
    contrasts.push_back(
        {{"set_delta_t_k", at.set_delta_t_k}, {"delta_t_k", at.delta_t_k}, {"speeds", speeds_json(at.speeds)}});
  Json time_constant;
  if (const auto& tau = found.time_constant)
    time_constant = {{"time_constant_ms", tau->time_constant_ms},
                     {"ci95_ms", json_interval(tau->ci95_ms)},
                     {"exposure_ms", tau->exposure_ms},
                     {"offset_px", tau->offset_px},
                     {"passes", tau->passes}};
  return {{"camera", found.camera},
          {"plan", plan.name},
          {"observer", plan.observer},
          {"frame_rate_hz", found.measured.frame_rate_hz},
          {"frames", plan.motion.frames},
          {"lead_frames", plan.motion.lead_frames},
          {"passes_per_speed", plan.motion.passes},
          {"places", to_string(plan.motion.places)},
          {"direction", "x, both ways in turn"},
          {"lag", "removed: triangles are judged where the picture shows them"},
          {"internal_noise", "per decision"},
          {"seed", plan.seed},
          {"residual_px", found.residual_px},
          {"frames_lost", found.measured.frames_lost},
          {"time_constant", time_constant},
          {"contrasts", contrasts},
          {"passes", passes_json(found.measured.passes)}};
}

int run_dynamic_plan(Console& console, const DynamicArguments& a, const Program& program) {
  auto loaded = read_plan(a.plan);
  if (!loaded) return report_error(console, loaded.error());
  if (program.common.seed_given) {
    Plan seeded = loaded->plan();
    seeded.seed = program.common.seed;
    loaded = loaded->with(std::move(seeded));
    if (!loaded) return report_error(console, loaded.error());
  }
  const Plan& plan = loaded->plan();
  console.phase("measuring before a target that moves");
  const auto said = [&](const MovingPassRecord& pass) {
    if (!pass.dropped.empty() && !console.json()) console.text(fmt::format("pass {}: {}", pass.pass, pass.dropped));
  };
  const auto found = measure_dynamic(*loaded, said, program.stop->token());
  if (!found) return report_error(console, found.error());
  if (console.json()) console.object(measured_json(*found, plan));
  std::vector<TableRow> rows;
  for (const DynamicContrast& at : found->contrasts) add_rows(rows, at.speeds, {fmt::format("{:g}", at.set_delta_t_k)});
  console.table(
      {"contrast (K)", "speed (mrad/s)", "px/frame", "observer", "acuity (1/mrad)", "95 %", "to rest", "95 %"}, rows);
  console.text(fmt::format("places of the large triangles are {:.3f} px from the line at the stage's speed",
                           found->residual_px));
  if (const auto& tau = found->time_constant)
    console.text(fmt::format("time constant {:.2f} ms, 95 % {}, from {} passes to the right and to the left",
                             tau->time_constant_ms, range(tau->ci95_ms, 2), tau->passes));
  return 0;
}

Json dynamic_json(const std::vector<DynamicAcuity>& found, const SensorSpec& sensor, const DynamicArguments& a,
                  std::uint64_t seed) {
  return {
      {"sensor", sensor.name},
      {"observer", a.observer},
      {"delta_t_k", a.delta_t_k},
      {"time_constant_ms", sensor.time_constant_ms},
      {"exposure_ms", sensor.exposure_ms},
      {"row_time_us", sensor.row_time_us},
      {"frame_rate_hz", sensor.frame_rate_hz},
      {"frames", a.frames},
      {"passes", a.passes},
      {"direction", "x, both ways in turn"},
      {"package", a.package.empty() ? Json() : Json(a.package)},
      {"lag", a.package.empty() ? "removed" : "that of time constant and exposure removed, that of the package not"},
      {"internal_noise", "per decision"},
      {"seed", seed},
      {"speeds", speeds_json(found)}};
}

int run_dynamic(Console& console, const DynamicArguments& a, const Program& program) {
  if (!a.plan.empty()) return run_dynamic_plan(console, a, program);
  if (a.speeds_mrad_s.empty())
    return report_error(console, {ErrorCode::invalid_input, "either a plan or --speeds-mrad-s is needed"});
  auto sensor = load_sensor(a.sensor);
  if (!sensor) return report_error(console, sensor.error());
  if (a.time_constant_ms >= 0) sensor->time_constant_ms = a.time_constant_ms;
  if (a.exposure_ms >= 0) sensor->exposure_ms = a.exposure_ms;
  if (a.row_time_us >= 0) sensor->row_time_us = a.row_time_us;
  if (auto valid = validate(*sensor); !valid) return report_error(console, valid.error());
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
  add_rows(rows, *found, {});
  console.table({"speed (mrad/s)", "px/frame", "observer", "acuity (1/mrad)", "95 %", "to static", "95 %"}, rows);
  return 0;
}

}  // namespace

void add_dynamic_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("dynamic", "acuity before a target that moves, beside one that rests");
  auto a = std::make_shared<DynamicArguments>();
  auto* plan =
      command->add_option("plan", a->plan, "name or file: its camera before a plate that moves as [motion] says");
  command->add_option("--sensor", a->sensor, "name or file")->capture_default_str();
  command->add_option("--observer", a->observer, "name or file")->capture_default_str();
  command->add_option("--delta-t-k", a->delta_t_k, "contrast in kelvin")
      ->capture_default_str()
      ->check(number_in(-1000, 1000));
  command->add_option("--speeds-mrad-s", a->speeds_mrad_s, "speeds along x; 0 is added")
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
  command->add_option("--exposure-ms", a->exposure_ms, "in place of the sensor's")->check(number_in(0, 1000));
  command->add_option("--row-time-us", a->row_time_us, "in place of the sensor's")->check(number_in(0, 1e4));
  command->add_option("--package", a->package, "file of stages behind the camera; their lag is not taken out");
  command->add_option("--accuracy", a->accuracy, "of the simulation")
      ->capture_default_str()
      ->check(CLI::IsMember({"draft", "normal"}));
  for (CLI::Option* option : command->get_options()) {
    if (option != plan && option != command->get_help_ptr()) option->excludes(plan);
  }
  finish_command(*command, program, [a, &program](Console& console) { return run_dynamic(console, *a, program); });
}

}  // namespace todbench
