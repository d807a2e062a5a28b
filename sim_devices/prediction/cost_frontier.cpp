#include "sim_devices/prediction/cost_frontier.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "sim_devices/prediction/direct_estimate.h"
#include "tod/test_pattern.h"

namespace todbench {
namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

/// One way of computing.
struct Setting {
  std::string knob, name;
  Accuracy accuracy;
  bool planned = false;  ///< effects of the planner, not all
  bool chosen = false;
};

std::vector<Setting> settings_of(const CostTask& task) {
  std::vector<Setting> out;
  const Accuracy draft = Accuracy::draft(), normal = Accuracy::normal(), reference = Accuracy::reference();
  const auto vary = [&](const char* knob, auto Accuracy::*field, auto values) {
    for (const auto value : values) {
      Accuracy accuracy = task.chosen;
      accuracy.*field = value;
      out.push_back({knob, number(static_cast<double>(value)), accuracy});
    }
  };
  vary("wavelengths", &Accuracy::wavelengths, std::vector{1, 2, 4, 16});
  vary("phases", &Accuracy::phases_per_axis, std::vector{2, 4, 8});
  vary("wrap", &Accuracy::wrap_tolerance, std::vector{1e-3, draft.wrap_tolerance, normal.wrap_tolerance});
  vary("band", &Accuracy::band_tolerance, std::vector{1e-2, draft.band_tolerance, normal.band_tolerance});
  vary("draws", &Accuracy::noise_draws, std::vector{50, 100, 200, 600, 1500});
  out.push_back({"planner", "draft", draft, true});
  out.push_back({"planner", "normal", normal, true});
  out.push_back({"planner", "reference", reference, true});
  out.push_back({"planner", "chosen: " + task.chosen_setting, task.chosen, true, true});
  return out;
}

struct Timed {
  std::vector<DirectPoint> points;
  double wall_s = 0;
};

Result<Timed> timed(const CostTask& task, const SensorPlan& effects, const Accuracy& accuracy, std::stop_token stop) {
  const auto begin = std::chrono::steady_clock::now();
  TemplateObserver observer(task.observer, triangle_alternatives());  // a new one: its banks are part of the price
  const DirectEstimateOptions options{
      .samples_per_pitch = 0, .motion = task.motion, .accuracy = accuracy, .seed = task.seed, .stop = std::move(stop)};
  auto points = direct_estimate(task.sensor, effects, observer, task.delta_t_k, options);
  if (!points) return tl::unexpected(points.error());
  return Timed{std::move(*points), std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count()};
}

double largest_error_percent(const Timed& found, const Timed& reference) {
  double largest = 0;
  for (std::size_t i = 0; i < found.points.size(); ++i)
    largest = std::max(largest, 100 * std::abs(reference.points[i].s75_pitch / found.points[i].s75_pitch - 1));
  return largest;
}

double largest_standard_error_percent(const Timed& found) {
  double largest = 0;
  for (const DirectPoint& point : found.points)
    largest = std::max(largest, 100 * point.standard_error_pitch / point.s75_pitch);
  return largest;
}

void mark_best(std::vector<CostPoint>& points) {
  for (CostPoint& point : points) {
    point.best = std::ranges::none_of(points, [&](const CostPoint& other) {
      return other.wall_s < point.wall_s && other.error_percent < point.error_percent;
    });
  }
}

}  // namespace

Result<CostFrontier> cost_frontier(const CostTask& task,
                                   const std::function<void(std::size_t, std::size_t)>& on_progress,
                                   std::stop_token stop) {
  const std::vector<Setting> settings = settings_of(task);
  const std::size_t steps = settings.size() + 2;
  const auto step_done = [&](std::size_t done) {
    if (on_progress) on_progress(done, steps);
  };
  auto whole = timed(task, task.full, Accuracy::reference(), stop);
  if (!whole) return fail("the reference", whole.error());
  step_done(1);
  Accuracy same_draws = Accuracy::reference();
  same_draws.noise_draws = task.chosen.noise_draws;
  same_draws.standard_error_percent = task.chosen.standard_error_percent;
  auto paired = timed(task, task.full, same_draws, stop);
  if (!paired) return fail("the reference", paired.error());
  step_done(2);

  CostFrontier out;
  out.reference_s = whole->wall_s;
  out.reference_standard_error_percent = largest_standard_error_percent(*whole);
  for (const Setting& setting : settings) {
    auto found = timed(task, setting.planned ? task.planned : task.full, setting.accuracy, stop);
    if (!found) return fail(setting.knob + " " + setting.name, found.error());
    const bool own = setting.knob != "draws" && setting.knob != "planner";
    out.points.push_back({.knob = setting.knob,
                          .setting = setting.name,
                          .wall_s = found->wall_s,
                          .error_percent = largest_error_percent(*found, own ? *paired : *whole),
                          .standard_error_percent = largest_standard_error_percent(*found),
                          .chosen = setting.chosen,
                          .best = false});
    step_done(out.points.size() + 2);
  }
  mark_best(out.points);
  return out;
}

}  // namespace todbench
