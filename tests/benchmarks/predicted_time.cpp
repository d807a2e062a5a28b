// SPDX-License-Identifier: GPL-3.0-or-later
// Predicted against actual time of several plans: simulated ones, and one measured with a simulated camera. Processor
// time of this process, so that other programs count as little as they can. Exit code 1 when a ratio is outside 1.35.
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <functional>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "bench/forecast/prediction.h"
#include "bench/run/experiment.h"

namespace todbench {
namespace {

constexpr double largest_factor = 1.35;

struct TimedPlan {
  std::string name;
  Plan plan;
  Side side = Side::simulated;
};

double processor_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

TimedPlan varied(const std::string& name, const std::function<void(Plan&)>& change) {
  TimedPlan timed{.name = name, .plan = load_plan("demo").value()};
  timed.plan.camera.id.clear();
  timed.plan.target.kind = TargetKind::scene;
  timed.plan.limits = {};
  change(timed.plan);
  return timed;
}

std::vector<TimedPlan> plans() {
  std::vector<TimedPlan> all;
  all.push_back(varied("demo", [](Plan&) {}));
  all.push_back(varied("draft, one contrast, one plate", [](Plan& p) {
    p.simulation.accuracy = "draft";
    p.schedule.frames_per_presentation = {8};
    p.target.delta_t_k = {16.9};
    p.target.plates = {"tcat-a"};
  }));
  all.push_back(varied("4 phases, tolerance 5 %", [](Plan& p) {
    p.simulation.phases = 4;
    p.simulation.accuracy = "auto";
    p.simulation.tolerance_percent = 5;
  }));
  all.push_back(varied("2x2 microscan, 4 phases", [](Plan& p) {
    p.simulation.microscan = 2;
    p.simulation.phases = 4;
    p.simulation.tolerance_percent = 2;
  }));
  all.push_back(varied("64 phases, one mounting", [](Plan& p) {
    p.simulation.phases = 64;
    p.target.mountings.resize(1);
  }));
  all.push_back(varied("tolerance 0.6 %, 0.23 K", [](Plan& p) {
    p.simulation.phases = 2;
    p.schedule.frames_per_presentation = {8};
    p.target.delta_t_k = {0.23};
    p.simulation.tolerance_percent = 0.6;
  }));
  // The twin of a measurement is a simulation of its own; both are in the actual time, and in the prediction.
  all.push_back(varied("measured with sim:sc2000, 6 phases", [](Plan& p) {
    p.camera.id = "sim:sc2000";
    p.target.phases = p.simulation.phases = 6;
  }));
  all.back().side = Side::measured;
  return all;
}

/// The ratio predicted / actual; nothing when the plan cannot be run.
Result<double> ratio_of(const TimedPlan& timed) {
  const auto folder = std::filesystem::temp_directory_path() / "todbench_predicted_time";
  const auto loaded = LoadedPlan::load(timed.plan);
  if (!loaded) return tl::unexpected(loaded.error());
  EffectPlanner planner;
  const auto inputs = experiment_inputs(*loaded, planner);
  if (!inputs) return tl::unexpected(inputs.error());
  auto prediction = predict_plan(timed.plan, *inputs);
  if (!prediction) return tl::unexpected(prediction.error());
  if (auto times = predict_times(timed.plan, *inputs, *prediction, {}); !times) return tl::unexpected(times.error());
  double predicted_s = *prediction->figures.predicted_s;
  if (timed.side == Side::measured) predicted_s += prediction->figures.predicted_measurement_s.value();
  const ExperimentOptions options{.folder = folder, .existing = ExistingFolder::overwrite};
  const double start = processor_seconds();
  const auto outcome =
      timed.side == Side::measured ? measure_plan(*loaded, options, {}, {}) : simulate_plan(*loaded, options, {}, {});
  const double actual_s = processor_seconds() - start;
  std::filesystem::remove_all(folder);
  if (!outcome) return tl::unexpected(outcome.error());
  const double ratio = predicted_s / actual_s;
  const bool within = ratio <= largest_factor && ratio >= 1 / largest_factor;
  std::printf("%-40s predicted %7.2f s, actual %7.2f s, ratio %.2f%s\n", timed.name.c_str(), predicted_s, actual_s,
              ratio, within ? "" : "  OUTSIDE 1.35");
  (void)std::fflush(stdout);
  return ratio;
}

int check_all() {
  cv::setNumThreads(1);
  int outside = 0;
  for (const TimedPlan& timed : plans()) {
    const auto ratio = ratio_of(timed);
    if (!ratio) std::printf("%-40s FAILED: %s\n", timed.name.c_str(), ratio.error().message.c_str());
    if (!ratio || *ratio > largest_factor || *ratio < 1 / largest_factor) ++outside;
  }
  return outside == 0 ? 0 : 1;
}

}  // namespace
}  // namespace todbench

int main() {
  return todbench::check_all();
}
