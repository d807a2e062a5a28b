// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/forecast/bench_time.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "bench/plan/descriptions.h"
#include "bench/twin/simulated_set_up.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

/// Shows what another shows and keeps the order.
class RecordingTarget final : public Target {
 public:
  explicit RecordingTarget(Target& shown) : shown_(shown) {}
  [[nodiscard]] const TargetCapabilities& capabilities() const override { return shown_.capabilities(); }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    states.push_back(state);
    return shown_.present(state, std::move(stop));
  }
  std::vector<TargetState> states;

 private:
  Target& shown_;
};

Plan small_plan() {
  Plan plan;
  plan.target.mountings = {Mounting::identity, Mounting::rotated_180};
  plan.target.delta_t_k = {16.9, 8};
  plan.target.phases = plan.simulation.phases = 2;
  plan.simulation.accuracy = "draft";
  plan.measurement.registration_frames = 3;
  plan.measurement.contrast_frames = 2;
  plan.measurement.frames_after_change = 0;  // as for the simulated camera, which has none in flight
  return plan;
}

struct Counted {
  std::uint64_t plate = 0, mounting = 0, contrast = 0, shift = 0;
  double seconds = 0;
};

/// Seconds that a black body of first order needs for a step, if it needs `longest_s` from 16.9 K to within 2 mK.
double settling_s(double step_k, double longest_s) {
  return longest_s * std::log(std::abs(step_k) / 0.002) / std::log(16.9 / 0.002);
}

/// What a target was asked for, one presentation after another.
Counted count(const std::vector<TargetState>& states, const TargetPlan& plan) {
  Counted counted;
  TargetState before{.plate = "", .mounting = Mounting::identity, .delta_t_k = 0, .shift_mm = {-1, -1}};
  for (const TargetState& state : states) {
    const bool first = &state == &states.front();
    double slowest = 0;
    const auto changes = [&](bool changed, double cost, std::uint64_t& times) {
      if (!first && !changed) return;
      ++times;
      slowest = std::max(slowest, cost);
    };
    changes(state.plate != before.plate, plan.plate_change_s, counted.plate);
    changes(state.mounting != before.mounting, plan.mounting_change_s, counted.mounting);
    changes(state.delta_t_k != before.delta_t_k,
            first ? plan.contrast_change_s : settling_s(state.delta_t_k - before.delta_t_k, plan.contrast_change_s),
            counted.contrast);
    changes(state.shift_mm != before.shift_mm, plan.shift_change_s, counted.shift);
    counted.seconds += slowest;
    before = state;
  }
  return counted;
}

class BenchTimeOfAMeasurement : public ::testing::TestWithParam<double> {};

TEST_P(BenchTimeOfAMeasurement, CountsTheChangesAndFramesThatMeasureAsksFor) {
  Plan plan = small_plan();
  plan.target.contrast_change_s = GetParam();
  const LoadedPlan loaded = LoadedPlan::load(plan).value();
  EffectPlanner planner;
  const ExperimentInputs inputs = experiment_inputs(loaded, planner).value();
  SimulatedSetUp set_up = simulated_set_up(plan, inputs, {}, {}).value();
  RecordingTarget target(*set_up.bench.target);
  TemplateObserver observer(inputs.observer, triangle_alternatives());
  UnattendedHost host;
  const auto measured = measure(*set_up.bench.camera, target, observer, *set_up.schedule, set_up.options, host, {}, {});
  ASSERT_TRUE(measured) << measured.error().message;
  ASSERT_FALSE(measured->ended_by);

  plan.target.kind = TargetKind::scpi;
  const BenchTime time = bench_time(plan, loaded.plates(), 50, {});

  const Counted counted = count(target.states, plan.target);
  EXPECT_EQ(time.presentations, target.states.size());
  EXPECT_EQ(time.plate_changes, counted.plate);
  EXPECT_EQ(time.mounting_changes, counted.mounting);
  EXPECT_EQ(time.contrast_changes, counted.contrast);
  EXPECT_EQ(time.shift_changes, counted.shift);
  EXPECT_NEAR(time.changes_s, counted.seconds, 1e-9);
  EXPECT_EQ(time.frames, measured->frames_used);
}

// 20 s: plate, mounting, contrast, shift from the outside in. 100 s: the contrast is the outermost.
INSTANTIATE_TEST_SUITE_P(ByContrastChange, BenchTimeOfAMeasurement, ::testing::Values(20.0, 100.0));

TEST(BenchTime, OfTheDefaultPlanIsThatOfTheSlowestChangeOfEachPresentation) {
  Plan plan;
  plan.target.kind = TargetKind::scpi;
  plan.target.black_body = plan.target.stage = "127.0.0.1:1";
  const LoadedPlan loaded = LoadedPlan::load(plan).value();

  const BenchTime time = bench_time(plan, loaded.plates(), 50, {});

  // 2 plates; 4 mountings each, the first with its plate; 3 contrasts each, the first with its set-up; 16 shifts each.
  EXPECT_EQ(time.plate_changes, 2u);
  EXPECT_EQ(time.mounting_changes, 8u);
  EXPECT_EQ(time.contrast_changes, 24u);
  EXPECT_EQ(time.shift_changes, 384u);
  EXPECT_NEAR(time.changes_s,
              2 * 60 + 6 * 30 + 8 * (settling_s(16.9 - 1.93, 20) + settling_s(1.93 - 0.23, 20)) + 360 * 0.1, 1e-9);
  // 6 exposures a presentation, 2 of them discarded, 32 to register each of 8 set-ups, 16 for each of their 24
  // contrasts.
  EXPECT_EQ(time.frames, 384u * (2 + 4) + 8 * 32 + 24 * 16);
  EXPECT_DOUBLE_EQ(time.frames_s, time.frames / 50.0);
}

TEST(BenchTime, HasTheFramesOfEachContrast) {
  Plan plan = small_plan();
  plan.target.delta_t_k = {16.9, 0.23};
  const LoadedPlan loaded = LoadedPlan::load(plan).value();
  plan.target.kind = TargetKind::scpi;
  plan.schedule.frames_per_presentation = {1};
  const BenchTime ones = bench_time(plan, loaded.plates(), 50, {});
  plan.schedule.frames_per_presentation = {3, 7};
  const BenchTime each = bench_time(plan, loaded.plates(), 50, {});

  EXPECT_EQ(each.frames, ones.frames + ones.presentations / 2 * (2 + 6));
}

TEST(BenchTime, ASimulatedSceneTakesNone) {
  const LoadedPlan loaded = LoadedPlan::load(Plan{}).value();

  EXPECT_EQ(bench_time(loaded.plan(), loaded.plates(), 50, {}).total_s(), 0);
}

TEST(BenchTime, OfAnAdaptivePlanGrowsWithWhatIsExpectedUpToItsCap) {
  Plan plan;
  plan.target.kind = TargetKind::prompt;
  plan.schedule.kind = ScheduleKind::adaptive;
  plan.schedule.max_presentations = 500;
  const LoadedPlan loaded = LoadedPlan::load(plan).value();
  plan.target.phases = 6;
  const auto of_visits = [&](std::size_t number) {
    AdaptiveRun run;
    for (std::size_t i = 0; i < number; ++i) run.push_back({.set_up = i % 8, .presentations = {6, 6, 6}});
    return bench_time(plan, loaded.plates(), 50, {run});
  };

  EXPECT_EQ(of_visits(2).presentations, 36u);
  EXPECT_EQ(of_visits(2).mounting_changes, 2u);
  EXPECT_LT(of_visits(2).total_s(), of_visits(3).total_s());
  EXPECT_EQ(of_visits(100).presentations, 500u);
  EXPECT_EQ(bench_time(plan, loaded.plates(), 50, {}).presentations, 500u);
}

TEST(BenchTime, OfAnAdaptivePlanIsTheMeanOfItsRunsWithARange) {
  Plan plan;
  plan.target.kind = TargetKind::prompt;
  plan.schedule.kind = ScheduleKind::adaptive;
  plan.target.phases = 6;
  plan.measures.noise = true;
  const LoadedPlan loaded = LoadedPlan::load(plan).value();
  const AdaptiveRun once{{.set_up = 0, .presentations = {6, 6, 6}}};
  const AdaptiveRun twice{{.set_up = 0, .presentations = {6, 6, 6}}, {.set_up = 1, .presentations = {0, 0, 5}}};
  const auto of = [&](const std::vector<AdaptiveRun>& runs) { return bench_time(plan, loaded.plates(), 50, runs); };
  const BenchTime few = of({once}), many = of({twice});

  const BenchTime both = of({once, twice});

  EXPECT_NEAR(both.total_s(), (few.total_s() + many.total_s()) / 2, 1e-9);
  EXPECT_EQ(both.presentations, (few.presentations + many.presentations + 1) / 2);
  EXPECT_NEAR(both.measures.at(0).changes_s, few.measures.at(0).changes_s, 1e-9);
  EXPECT_NEAR(both.short_s, few.total_s(), 1e-9);
  EXPECT_NEAR(both.long_s, many.total_s(), 1e-9);
  EXPECT_EQ(few.short_s, few.long_s);
}

TEST(BenchTime, OfAnAdaptivePlanLooksAtTheHighestContrastInEverySetUpThatAnotherContrastNeeds) {
  Plan plan;
  plan.target.kind = TargetKind::prompt;
  plan.schedule.kind = ScheduleKind::adaptive;
  plan.target.phases = 6;
  plan.target.delta_t_k = {10, 1};
  const LoadedPlan loaded = LoadedPlan::load(plan).value();

  // Set-ups a0, a1, a1 again, a2 and a2 again.
  const AdaptiveRun run{{.set_up = 0, .presentations = {6, 6}},
                        {.set_up = 1, .presentations = {2, 6}},
                        {.set_up = 1, .presentations = {0, 6}},
                        {.set_up = 2, .presentations = {0, 6}},
                        {.set_up = 2, .presentations = {0, 6}}};

  const BenchTime time = bench_time(plan, loaded.plates(), 50, {run});

  EXPECT_EQ(time.mounting_changes, 3u);
  EXPECT_EQ(time.presentations, 8u + 1u + 30u) << "one look at 10 K in the third set-up";
  EXPECT_EQ(time.contrast_changes, 6u);
}

TEST(BenchTimeOfMeasures, AddsTheirStepsAndFrames) {
  Plan plan = small_plan();
  plan.target.kind = TargetKind::scpi;
  plan.camera.ifov_mrad = 1.3;
  plan.measurement.frames_after_change = 1;
  const std::vector<TargetPlate> plates{load_plate("tcat-a").value()};
  const BenchTime trials = bench_time(plan, plates, 50, {});

  plan.measures.noise = true;
  const BenchTime noise = bench_time(plan, plates, 50, {});
  plan.measures.transfer = true;
  const BenchTime both = bench_time(plan, plates, 50, {});

  // To find the plate 3 frames, the cube 64, each of the 6 steps 2; and one that is discarded after each change.
  EXPECT_EQ(noise.frames - trials.frames, 3 + 64 + 2u);
  EXPECT_EQ(both.frames - noise.frames, 6 * (2 + 1u));
  EXPECT_NEAR(both.changes_s - noise.changes_s, 6 * plan.target.contrast_change_s, 1e-9);
  EXPECT_GE(noise.changes_s - trials.changes_s, 2 * plan.target.contrast_change_s);
  EXPECT_EQ(both.presentations, trials.presentations);
  ASSERT_EQ(both.measures.size(), 2u);
  EXPECT_EQ(both.measures[0].measure, "transfer");
  EXPECT_EQ(both.measures[0].frames, both.frames - noise.frames);
  EXPECT_NEAR(both.measures[0].changes_s, both.changes_s - noise.changes_s, 1e-9);
  EXPECT_EQ(both.measures[1].measure, "noise");
  EXPECT_EQ(both.measures[1].frames, 64 + 1u);
  EXPECT_EQ(both.all_measures.frames, both.frames - trials.frames);
  EXPECT_NEAR(both.all_measures.changes_s, both.changes_s - trials.changes_s, 1e-9);
  plan.measures.triangles = true;
  const BenchTime triangles = bench_time(plan, plates, 50, {});
  EXPECT_EQ(triangles.frames - both.frames, plan.target.delta_t_k.size() * (2 + 1u));
  plan.measures.triangles = false;
  plan.measures.mtf = true;
  const BenchTime mtf = bench_time(plan, plates, 50, {});
  EXPECT_EQ(mtf.frames - both.frames, 64 + 1u);
  EXPECT_NEAR(mtf.changes_s - both.changes_s, std::max(plan.target.plate_change_s, plan.target.contrast_change_s),
              1e-9);
}

TEST(ResumeRemark, IsMadeOfALongRunThatKeepsNoFrames) {
  Plan plan;
  plan.target.kind = TargetKind::scpi;
  EXPECT_EQ(resume_remark(plan, 599), "");
  EXPECT_NE(resume_remark(plan, 7200).find("about 120 minutes and keeps no frames"), std::string::npos);
  plan.measurement.record_frames = true;
  EXPECT_EQ(resume_remark(plan, 7200), "");
  plan.measurement.record_frames = false;
  plan.target.kind = TargetKind::scene;
  EXPECT_EQ(resume_remark(plan, 7200), "");
}

}  // namespace
}  // namespace todbench
