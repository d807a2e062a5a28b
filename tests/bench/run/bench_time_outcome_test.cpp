// SPDX-License-Identifier: GPL-3.0-or-later
// Forecast bench time against the time that measurements take, in simulated time: a stage with its change times, a
// black body of first order, a camera of its frame rate.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "acquisition/base/distributions.h"
#include "acquisition/core/forwarding_source.h"
#include "bench/devices/devices.h"
#include "bench/forecast/bench_time.h"
#include "bench/forecast/bill_forecast.h"
#include "bench/forecast/design_search.h"
#include "bench/forecast/interval_prediction.h"
#include "bench/forecast/prediction.h"
#include "bench/plan/descriptions.h"
#include "bench/plan/plan_options.h"
#include "bench/twin/experiment_inputs.h"
#include "bench/twin/simulated_responses.h"
#include "bench/twin/twin_shapes.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

struct LaboratoryTime {
  double now_s = 0;
};

/// Every frame takes its period.
class TimedCamera final : public ForwardingSource {
 public:
  TimedCamera(std::unique_ptr<FrameSource> camera, std::shared_ptr<LaboratoryTime> time)
      : ForwardingSource(std::move(camera)), time_(std::move(time)) {}
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds timeout) override {
    time_->now_s += 1 / info().frame_rate_hz;
    return ForwardingSource::next(timeout);
  }

 private:
  std::shared_ptr<LaboratoryTime> time_;
};

/// Changes run in parallel. The black body approaches its set-point exponentially, and settles from the strongest
/// contrast within 2 mK of nothing in the stated time.
class TimedTarget final : public Target {
 public:
  TimedTarget(std::unique_ptr<Target> scene, std::shared_ptr<LaboratoryTime> time, const Plan& plan)
      : scene_(std::move(scene)), time_(std::move(time)), plan_(plan) {
    double strongest_k = plan.schedule.from_delta_t_k.value_or(0);
    for (const double delta_t_k : plan.target.delta_t_k) strongest_k = std::max(strongest_k, std::abs(delta_t_k));
    tau_s_ = plan.target.contrast_change_s / std::log(strongest_k / settled_k);
  }
  [[nodiscard]] const TargetCapabilities& capabilities() const override { return scene_->capabilities(); }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    const TargetPlan& target = plan_.target;
    const bool first = before_.plate.empty();
    drift_to(time_->now_s);
    set_k_ = state.delta_t_k;
    double wait_s = contrast_wait_s(state.wait);
    if (first || before_.plate != state.plate) wait_s = std::max(wait_s, target.plate_change_s);
    if (first || before_.mounting != state.mounting) wait_s = std::max(wait_s, target.mounting_change_s);
    if (first || before_.shift_mm != state.shift_mm) wait_s = std::max(wait_s, target.shift_change_s);
    time_->now_s += wait_s;
    drift_to(time_->now_s);
    before_ = state;
    TargetState shown = state;
    shown.delta_t_k = body_k_;
    return scene_->present(shown, std::move(stop));
  }

 private:
  static constexpr double settled_k = 0.002;
  void drift_to(double now_s) {
    body_k_ = set_k_ + (body_k_ - set_k_) * std::exp(-(now_s - body_s_) / tau_s_);
    body_s_ = now_s;
  }
  [[nodiscard]] double contrast_wait_s(ContrastWait wait) const {
    if (wait == ContrastWait::none) return 0;
    const double percent = plan_.target.contrast_settling_band_percent;
    const double band = std::min(percent > 0 ? percent / 100 : 0.1, 0.06 * tau_s_);
    const double near_k = wait == ContrastWait::within_band ? band * std::abs(set_k_) : settled_k;
    const double away_k = std::abs(body_k_ - set_k_);
    return away_k > near_k ? tau_s_ * std::log(away_k / near_k) : 0;
  }

  std::unique_ptr<Target> scene_;
  std::shared_ptr<LaboratoryTime> time_;
  const Plan& plan_;
  double tau_s_ = 1, body_k_ = 0, set_k_ = 0, body_s_ = 0;
  TargetState before_{};
};

/// A bench of defaults with the simulated SC2000.
Plan bench_plan() {
  Plan plan;
  plan.name = "bench time";
  plan.camera.id = "sim:sc2000";
  plan.camera.ifov_mrad = load_sensor("sc2000")->ifov_mrad();
  plan.camera.nuc_interval_s = 0;
  plan.target.kind = TargetKind::scpi;
  plan.target.black_body = plan.target.stage = "127.0.0.1:1";
  plan.target.phases = 6;
  plan.simulation.accuracy = "draft";
  return plan;
}

ExperimentInputs inputs_for(const Plan& plan) {
  EffectPlanner planner;
  return experiment_inputs(LoadedPlan::load(plan).value(), planner).value();
}

/// Time of a measurement on the simulated bench.
double outcome_s(const Plan& asked, const ExperimentInputs& inputs) {
  const Plan plan = with_frames(asked, inputs);
  const LoadedPlan loaded = LoadedPlan::load(plan).value();
  const auto model = std::make_shared<const SensorModel>(loaded.sensor(), full_plan(loaded.sensor(), {}, {}),
                                                         inputs.accuracy, plan.seed + 1);
  const auto time = std::make_shared<LaboratoryTime>();
  OpenedBench bench = simulated_bench(model, loaded.shown_plates(), plan.target.distance_m, {});
  TimedCamera camera(std::move(bench.camera), time);
  TimedTarget target(std::move(bench.target), time, plan);
  MeasurementOptions options = camera_options(plan, inputs.plates);
  take_answers(options, plan, inputs);
  options.max_shift_error_px = 0;
  options.free_running = false;
  options.contrast_response = simulated_responses(SensorModel(inputs.sensor, inputs.effects, inputs.accuracy, 1), plan,
                                                  inputs.plates, options, {})
                                  .value();
  const auto functions = stopping_tables(plan, inputs, {}).value();
  const auto schedule = make_schedule(plan, inputs.plates, plan.camera.ifov_mrad, Side::measured,
                                      RandomStream(plan.seed, "schedule"), functions);
  TemplateObserver observer(inputs.observer, triangle_alternatives());
  const auto run = measure(camera, target, observer, *schedule, options, *bench.host, {}, {});
  if (!run || run->ended_by) ADD_FAILURE() << (run ? run->ended_by->message : run.error().message);
  return time->now_s;
}

struct Outcomes {
  double mean_ratio = 0;        ///< of outcome over forecast
  double forecast_scatter = 0;  ///< standard deviation of single runs over the forecast, by the simulated runs
  int in_range = 0;             ///< runs within the range of eight of ten simulated runs
};

Outcomes outcomes(const std::string& name, Plan plan, int seeds) {
  const ExperimentInputs inputs = inputs_for(plan);
  const double forecast_s = bill_forecast(plan, inputs).value().total_s;
  const Plan planned = as_measured(with_frames(plan, inputs));
  const BenchTime time = expected_bench_time(planned, inputs, predict_plan(planned, inputs).value());
  const double tenth = distribution::quantile(distribution::Normal(), 0.9);
  Outcomes out{.forecast_scatter = (time.long_s - time.short_s) / (2 * tenth) / forecast_s};
  for (int seed = 1; seed <= seeds; ++seed) {
    plan.seed = static_cast<std::uint64_t>(seed);
    const double taken_s = outcome_s(plan, inputs);
    std::printf("%s, seed %d: forecast %.0f s (%.0f to %.0f), run %.0f s, ratio %.3f\n", name.c_str(), seed, forecast_s,
                time.short_s, time.long_s, taken_s, taken_s / forecast_s);
    out.mean_ratio += taken_s / forecast_s / seeds;
    const double rounded_s = std::round(taken_s);
    out.in_range += rounded_s >= std::round(time.short_s) && rounded_s <= std::round(time.long_s) ? 1 : 0;
  }
  return out;
}

/// Outcome over forecast of one run.
double outcome_over_forecast(const std::string& name, const Plan& plan) {
  return outcomes(name, plan, 1).mean_ratio;
}

double forecast_of(const AccuracyBill& bill, std::string_view part) {
  for (const BillRow& row : bill.rows) {
    if (row.part == part) return row.seconds.value_or(NAN);
  }
  return 0;
}

TEST(BillForecast, SeparatesPhysicalMeasuresAndLeavesOutTheWarmUp) {
  Plan plan = bench_plan();
  plan.schedule.frames_per_presentation = {4};
  const AccuracyBill trials = bill_forecast(plan, inputs_for(plan)).value();
  plan.measures.noise = true;
  plan.camera.warm_up.time_s = 1800;

  const AccuracyBill bill = bill_forecast(plan, inputs_for(plan)).value();

  EXPECT_NEAR(forecast_of(bill, changes_part), forecast_of(trials, changes_part), 1e-6);
  EXPECT_GT(forecast_of(bill, measures_part), 2 * plan.target.contrast_change_s);
  EXPECT_NEAR(forecast_of(bill, measures_part), bill.total_s - trials.total_s, 1e-6);
}

TEST(BillForecast, StatesTheLeastTimeAndTheEffectsLeftOutOrWhyItCannot) {
  Plan plan = bench_plan();
  const AccuracyBill without = bill_forecast(plan, inputs_for(plan)).value();
  plan.simulation.skip = {Effect::detector};
  plan.limits.acuity = {{plan.target.delta_t_k.front(), 0.1}};

  const AccuracyBill with = bill_forecast(plan, inputs_for(plan)).value();

  const auto has = [](const AccuracyBill& bill, std::string_view text) {
    return std::ranges::any_of(bill.sentences, [&](const std::string& sentence) { return sentence.find(text) == 0; });
  };
  EXPECT_TRUE(has(without, no_budget_sentence) && has(without, no_limit_sentence));
  EXPECT_FALSE(has(with, no_limit_sentence));
  EXPECT_TRUE(has(with, "The decision on the predicted acuity at"));
  EXPECT_TRUE(has(with, "In the set-ups of the plan, the decisions on acuity alone need about"));
  EXPECT_TRUE(has(with, "The simulation leaves out on request: detector"));
}

// Fits of ten measured runs (adaptive, 3 %, 10 and 1 K, seeds 1 to 10): 9.8 degrees of freedom after 24 presentations
// of 10 K in four set-ups, 4.6 to 5 after the six of the first.
TEST(AnswerForecast, HasTheDegreesOfFreedomOfPresentationsOrPlaces) {
  Plan plan = bench_plan();
  plan.target.delta_t_k = {10, 1};
  const ExperimentInputs inputs = inputs_for(plan);
  const Plan planned = as_measured(with_frames(plan, inputs));
  const AnswerForecast answers = answer_forecast(planned, inputs, 10).value();
  const auto freedom_after = [&](const std::vector<int>& shown) {
    ContrastPrediction point;
    predict_interval(point, planned, inputs, answers, shown);
    EXPECT_FALSE(point.over_set_ups);
    return *point.degrees_of_freedom;
  };
  std::vector<int> shown(answers.information.size());

  shown[0] = plan.target.phases;
  EXPECT_NEAR(freedom_after(shown), 4.8, 0.4);
  std::fill_n(shown.begin(), 4, plan.target.phases);
  EXPECT_NEAR(freedom_after(shown), 9.8, 1);
}

TEST(BenchTimeOutcome, OfConstantStimuliIsTheForecast) {
  EXPECT_NEAR(outcome_over_forecast("constant", bench_plan()), 1, 0.1);
}

TEST(BenchTimeOutcome, WithinASettlingBandIsTheForecast) {
  Plan plan = bench_plan();
  plan.target.contrast_settling_band_percent = 10;
  EXPECT_NEAR(outcome_over_forecast("settling band", plan), 1, 0.1);
}

/// An adaptive plan and the seeds of the short form.
struct AdaptiveRow {
  const char* name;
  double half_width_percent;
  int phases = 6;
  std::vector<double> delta_t_k{16.9, 1.93, 0.23};
  AnswersChoice answers = AnswersChoice::automatic;
  int short_seeds = 0;
};

std::vector<AdaptiveRow> adaptive_rows() {
  return {{.name = "adaptive, 3 %", .half_width_percent = 3, .short_seeds = 2},
          {.name = "adaptive, 3 %, 12 phases", .half_width_percent = 3, .phases = 12},
          {.name = "adaptive, 2 %", .half_width_percent = 2},
          {.name = "adaptive, 5 %", .half_width_percent = 5},
          {.name = "adaptive, 3 %, 10 and 1 K", .half_width_percent = 3, .delta_t_k = {10, 1}, .short_seeds = 1},
          {.name = "adaptive, 3 %, 10 and 1 K, 12 phases", .half_width_percent = 3, .phases = 12, .delta_t_k = {10, 1}},
          {.name = "adaptive, 2 %, 10 and 1 K", .half_width_percent = 2, .delta_t_k = {10, 1}},
          {.name = "adaptive, 3 %, six contrasts", .half_width_percent = 3, .delta_t_k = {16.9, 8, 3, 1, 0.5, 0.2}},
          {.name = "adaptive, 4 %, 0.5 K alone", .half_width_percent = 4, .delta_t_k = {0.5}},
          {.name = "adaptive, 8 %, binary answers", .half_width_percent = 8, .answers = AnswersChoice::binary}};
}

// Single runs differ by whole set-ups. The tolerance is 3.3 standard errors of the mean by the scatter of the simulated
// runs, and a tenth. TODBENCH_STUDY_RUNS: seeds of every row.
TEST(BenchTimeOutcome, OfAnAdaptiveScheduleIsTheForecast) {
  const char* asked = std::getenv("TODBENCH_STUDY_RUNS");
  for (const AdaptiveRow& row : adaptive_rows()) {
    Plan plan = bench_plan();
    plan.schedule.kind = ScheduleKind::adaptive;
    plan.schedule.half_width_percent = row.half_width_percent;
    plan.target.phases = row.phases;
    plan.target.delta_t_k = row.delta_t_k;
    plan.schedule.answers = row.answers;
    const int seeds = asked != nullptr ? std::atoi(asked) : row.short_seeds;
    if (seeds == 0) continue;
    const Outcomes found = outcomes(row.name, plan, seeds);
    std::printf("%s: %d seeds, mean ratio %.3f, %d within the range\n", row.name, seeds, found.mean_ratio,
                found.in_range);
    EXPECT_NEAR(found.mean_ratio, 1, 0.1 + 3.3 * found.forecast_scatter / std::sqrt(seeds)) << row.name;
  }
}

TEST(BenchTimeOutcome, OfTheBestDesignIsTheForecast) {
  const Plan plan = bench_plan();
  const auto best = best_design(plan, inputs_for(plan), {.half_width_percent = 2.5}, {});
  ASSERT_TRUE(best) << best.error().message;
  EXPECT_NEAR(outcome_over_forecast("optimised", best->best.plan), 1, 0.1);
}

TEST(BenchTimeOutcome, OfARampIsTheForecast) {
  Plan plan = bench_plan();
  plan.schedule.kind = ScheduleKind::ramp;
  plan.schedule.ramp_k_per_s = 7.3;
  plan.schedule.from_delta_t_k = 16.9;
  plan.schedule.to_delta_t_k = 0.23;
  plan.target.max_contrast_lag_s = 0;
  EXPECT_NEAR(outcome_over_forecast("ramp", plan), 1, 0.1);
}

}  // namespace
}  // namespace todbench
