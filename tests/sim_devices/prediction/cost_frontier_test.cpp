// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/cost_frontier.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/sim_devices/reference.h"
#include "tests/tod/measurement/fake_clock.h"

namespace todbench {
namespace {

/// A draft at a contrast whose thresholds take little time.
CostTask quick_task() {
  CostTask task;
  task.sensor = test::sc2000();
  task.full = full_plan(task.sensor, {}, {});
  task.delta_t_k = {16.9};
  task.choices = {{.setting = "as planned", .effects = task.full, .accuracy = Accuracy::draft(), .chosen = true},
                  {.setting = "reference", .effects = task.full, .accuracy = Accuracy::reference()}};
  task.trials = {{.setting = "a trial", .relative_cost = 1, .measure = [](std::stop_token) {
                    return Result<std::vector<ThresholdEstimate>>({{16.9, 1.6, std::nullopt}});
                  }}};
  task.budget_s = 600;
  return task;
}

TEST(CostFrontier, MeasuresEveryKnobAndThePlannersChoicesAgainstTheReference) {
  const CostTask task = quick_task();
  std::size_t done = 0, all = 0;

  const auto frontier =
      cost_frontier(task, {.on_progress = [&](std::size_t d, std::size_t a) { done = d, all = a; }}, {});

  ASSERT_TRUE(frontier) << frontier.error().message;
  EXPECT_EQ(done, all);
  EXPECT_EQ(frontier->points.size(), all);
  for (const char* knob : {"tolerance", "wavelengths", "phases", "wrap", "band", "draws"})
    EXPECT_GE(std::ranges::count(frontier->points, knob, &CostPoint::knob), 3) << knob;
  EXPECT_EQ(std::ranges::count(frontier->points, true, &CostPoint::chosen), 1);
  EXPECT_GE(std::ranges::count(frontier->points, true, &CostPoint::best), 1);
  EXPECT_EQ(frontier->reference_draws, Accuracy::reference().noise_draws);
  for (const CostPoint& point : frontier->points) {
    const std::string name = point.knob + " " + point.setting;
    ASSERT_TRUE(point.measured()) << name << ": " << point.not_measured;
    // The reference again, and each knob at its setting there: the same numbers.
    const bool same = point.setting == "reference" || (point.knob == "wavelengths" && point.setting == "16") ||
                      (point.knob == "phases" && point.setting == "8");
    if (same) {
      EXPECT_EQ(point.error_percent, 0) << name;
    }
    // 50 draws have a standard error of 3 % and less; nothing is off by more than four of them and a few per cent.
    EXPECT_LT(*point.error_percent, 15) << name;
    if (point.knob == "trials") {
      EXPECT_NEAR(*point.error_percent, 100 * std::abs(frontier->reference.front().s75_pitch / 1.6 - 1), 1e-9);
      EXPECT_FALSE(point.standard_error_percent);
    }
  }
}

TEST(CostFrontier, RefusesABudgetThatEndsBeforeTheReference) {
  CostTask task = quick_task();
  task.budget_s = 1e-3;

  const auto nothing = cost_frontier(task, {}, {});

  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(nothing.error().message, ::testing::HasSubstr("a budget of 0.001 s is too short"));
}

TEST(CostFrontier, LeavesUnmeasuredWhatDoesNotFitIntoTheBudget) {
  // A millisecond passes with every reading, whatever the machine: all but the trials is far within the budget.
  FakeClock clock(1e-3);
  CostTask task = quick_task();
  task.now = clock.now();
  task.choices.resize(1);
  task.trials.front().measure = [&](std::stop_token) -> Result<std::vector<ThresholdEstimate>> {
    clock.advance(task.budget_s);
    return fail(ErrorCode::interrupted, "stopped on request");
  };

  const auto frontier = cost_frontier(task, {}, {});

  ASSERT_TRUE(frontier) << frontier.error().message;
  EXPECT_EQ(frontier->reference_draws, Accuracy::reference().noise_draws);
  for (const CostPoint& point : frontier->points) {
    const bool before = point.knob == "planner";
    EXPECT_EQ(point.measured(), before) << point.knob << " " << point.setting;
    if (!before) {
      EXPECT_THAT(point.not_measured, ::testing::HasSubstr("the budget of 600 s")) << point.knob;
    }
  }
}

TEST(CostFrontier, DoesNotCountTheTimeOfOtherPrograms) {
  FakeClock clock(1e-3);
  CostTask task = quick_task();
  task.now = clock.now();
  task.choices.resize(1);
  // Half a minute passes in which this program has no processor.
  task.trials.front().measure = [&](std::stop_token) -> Result<std::vector<ThresholdEstimate>> {
    clock.advance(30);
    return std::vector<ThresholdEstimate>{{16.9, 1.6, std::nullopt}};
  };

  const auto frontier = cost_frontier(task, {}, {});

  ASSERT_TRUE(frontier) << frontier.error().message;
  const auto trials = std::ranges::find(frontier->points, "trials", &CostPoint::knob);
  ASSERT_NE(trials, frontier->points.end());
  ASSERT_TRUE(trials->measured()) << trials->not_measured;
  EXPECT_LT(*trials->wall_s, 1);
  EXPECT_GT(frontier->spent_s, 30) << "the budget is one of wall time";
}

TEST(CostFrontier, IsEmptyWithAReasonWhereNoContrastHasAThreshold) {
  CostTask task = quick_task();
  task.delta_t_k = {0.001};

  const auto frontier = cost_frontier(task, {}, {});

  ASSERT_TRUE(frontier) << frontier.error().message;
  EXPECT_TRUE(frontier->reference.empty());
  EXPECT_TRUE(frontier->points.empty());
  ASSERT_EQ(frontier->notes.size(), 1u);
  EXPECT_THAT(frontier->notes.front(), ::testing::StartsWith("0.001 K is omitted: "));
}

TEST(CostFrontier, StopsOnRequest) {
  std::stop_source stop;
  CostTask task = quick_task();
  task.trials.front().measure = [&](std::stop_token) -> Result<std::vector<ThresholdEstimate>> {
    stop.request_stop();
    return fail(ErrorCode::interrupted, "stopped on request");
  };

  const auto frontier = cost_frontier(task, {}, stop.get_token());

  ASSERT_FALSE(frontier);
  EXPECT_EQ(frontier.error().code, ErrorCode::interrupted);
}

}  // namespace
}  // namespace todbench
