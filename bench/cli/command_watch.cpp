// SPDX-License-Identifier: GPL-3.0-or-later
// todbench watch
#include "acquisition/base/try.h"
#include "bench/cli/commands.h"

#include <chrono>
#include <memory>

#include "bench/devices/devices.h"
#include "bench/judgement/verdict.h"
#include "bench/text/text.h"
#include "tod/camera_measures/warm_up_measure.h"

namespace todbench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double most_rejected_share = 0.5;                            ///< a camera that warms up corrects itself often
constexpr std::string_view temperature_feature = "DeviceTemperature";  // SFNC

struct WatchArguments {
  std::string camera;
  double minutes = 10, stable_k_per_min = WarmUpOptions{}.stable_k_per_min;
};

struct WatchedWarmUp {
  SourceInfo camera;
  double first_image_s = 0;
  WarmUp warm_up;
};

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

Result<WatchedWarmUp> watched(Console& console, const WatchArguments& arguments, const std::stop_token& stop) {
  const auto begin = Clock::now();
  const CameraPatience patience{
      .longest = std::chrono::milliseconds(static_cast<long>(60'000 * arguments.minutes)),
      .on_waiting = [&](const Error& reason) { console.waiting("waiting for the camera: " + reason.message); }};
  const auto camera = open_when_there(arguments.camera, patience, stop);
  if (!camera) return tl::unexpected(camera.error());
  FrameSource& source = **camera;
  const SourceInfo info = source.info();
  TODBENCH_TRY_VOID(source.start());
  FrameTakerOptions options;
  options.integrity = {.width = info.width, .height = info.height};
  options.frames_after_change = 0;
  options.max_rejected_share = most_rejected_share;
  FrameTaker taker(source, options);
  if (auto first = taker.discard(stop); !first) return fail("waiting for the first image", first.error());
  const double first_image_s = seconds_since(begin);
  console.phase("watching the camera warm up");
  const auto temperature = [&source]() -> std::optional<double> {
    const auto text = source.get(std::string(temperature_feature));
    return text ? parse_number(*text) : std::nullopt;
  };
  auto warm_up = measure_warm_up(taker,
                                 {.duration_s = 60 * arguments.minutes,
                                  .start_s = first_image_s,
                                  .frame_rate_hz = info.frame_rate_hz,
                                  .stable_k_per_min = arguments.stable_k_per_min},
                                 temperature, stop);
  source.stop();
  if (!warm_up) return tl::unexpected(warm_up.error());
  return WatchedWarmUp{info, first_image_s, std::move(*warm_up)};
}

Json law_json(const DriftLaw& law, const DriftFit& fit) {
  return {{"shape", to_string(fit.shape)},
          {"from_s", json_number(law.time_s.front())},
          {"to_s", json_number(law.time_s.back())},
          {"change_k", json_number(fit.change_k)},
          {"change_ci95_k", json_interval(fit.change_ci95)},
          {"k_per_min", json_number(law.per_minute(fit.change_k))},
          {"time_constant_s", json_number(fit.time_constant_s)},
          {"time_constant_ci95_s", json_interval(fit.time_constant_ci95)},
          {"p_linear", json_number(fit.p_linear)}};
}

Json watch_json(const WatchedWarmUp& watched, const WatchArguments& arguments) {
  const WarmUp& w = watched.warm_up;
  Json groups = Json::array();
  for (const WarmUpGroup& group : w.groups) {
    groups.push_back({{"time_s", json_number(group.time_s)},
                      {"frames", group.frames},
                      {"mean_k", json_number(group.mean_k)},
                      {"fixed_pattern_k", json_number(group.pattern_k)},
                      {"netd_k", json_number(group.noise_k)},
                      {"camera_temperature_c", json_number(group.camera_temperature_c)},
                      {"corrected", group.corrected}});
  }
  return {{"camera", watched.camera.id},
          {"time_to_first_image_s", json_number(watched.first_image_s)},
          {"time_to_stability_s", json_number(w.stable_s)},
          {"stable_k_per_min", arguments.stable_k_per_min},
          {"level", w.law ? law_json(*w.law, w.law->level) : Json()},
          {"pattern", w.law ? law_json(*w.law, w.law->pattern) : Json()},
          {"level_per_camera_temperature", w.by_temperature ? Json{{"slope", json_number(w.by_temperature->slope)},
                                                                   {"slope_u", json_number(w.by_temperature->slope_u)}}
                                                            : Json()},
          {"groups", groups},
          {"reasons", w.reasons}};
}

void print_watch(const Console& console, const WatchedWarmUp& watched) {
  std::vector<TableRow> rows;
  for (const WarmUpGroup& group : watched.warm_up.groups) {
    rows.push_back({fixed(group.time_s, 1), fixed(group.mean_k, 3), fixed(1000 * group.pattern_k, 1),
                    fixed(1000 * group.noise_k, 1), fixed(group.camera_temperature_c, 2),
                    group.corrected ? "correction" : ""});
  }
  console.table({"time [s]", "mean [K]", "fixed pattern [mK]", "NETD [mK]", "camera [°C]", ""}, rows);
  console.text("first image after " + fixed(watched.first_image_s, 1) + " s; stable after " +
               fixed(watched.warm_up.stable_s, 1) + " s");
  if (const auto& law = watched.warm_up.law) {
    console.text("level: " + std::string(to_string(law->level.shape)) + ", " +
                 fixed(law->per_minute(law->level.change_k), 4) + " K/min, time constant " +
                 fixed(law->level.time_constant_s, 1) + " s (" + range(law->level.time_constant_ci95, 1) + ")");
  }
  for (const std::string& reason : watched.warm_up.reasons) console.text(reason);
}

int run_watch(Console& console, const WatchArguments& arguments, const std::stop_token& stop) {
  const auto found = watched(console, arguments, stop);
  console.end_progress();
  if (!found) return report_error(console, found.error());
  if (console.json()) {
    console.object(watch_json(*found, arguments));
  } else {
    print_watch(console, *found);
  }
  return exit_code(found->warm_up.stable_s ? VerdictKind::pass : VerdictKind::inconclusive);
}

}  // namespace

void add_watch_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand(
      "watch",
      "observes a camera that warms up before a uniform scene: first image, drift of level, pattern and noise, with "
      "times from the start of the command");
  auto a = std::make_shared<WatchArguments>();
  command->add_option("CAMERA", a->camera, "camera id, as listed by todbench devices; awaited if it is absent")
      ->required();
  command->add_option("--minutes", a->minutes, "duration of the observation after the first image")
      ->check(number_in(0.05, 10000))
      ->capture_default_str();
  command
      ->add_option("--stable-k-per-min", a->stable_k_per_min,
                   "the camera is stable when its level drifts more slowly than this, in K/min")
      ->check(number_in(1e-6, 100))
      ->capture_default_str();
  finish_command(*command, program,
                 [a, &program](Console& console) { return run_watch(console, *a, program.stop->token()); });
}

}  // namespace todbench
