#include "sim_devices/prediction/cost_frontier.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/sim_devices/reference.h"

namespace todbench {
namespace {

TEST(CostFrontier, MeasuresEveryKnobAndThePlannersChoicesAgainstTheReference) {
  CostTask task;
  task.sensor = test::sc2000();
  task.full = task.planned = full_plan(task.sensor, {}, {});
  task.delta_t_k = {16.9};
  task.chosen = Accuracy::draft();
  task.chosen_setting = "draft";
  std::size_t done = 0, steps = 0;

  const auto frontier = cost_frontier(task, [&](std::size_t d, std::size_t s) { done = d, steps = s; }, {});

  ASSERT_TRUE(frontier) << frontier.error().message;
  EXPECT_EQ(done, steps);
  EXPECT_EQ(frontier->points.size() + 2, steps);
  for (const char* knob : {"wavelengths", "phases", "wrap", "band", "draws", "planner"})
    EXPECT_GE(std::ranges::count(frontier->points, knob, &CostPoint::knob), 3) << knob;
  EXPECT_EQ(std::ranges::count(frontier->points, true, &CostPoint::chosen), 1);
  EXPECT_GE(std::ranges::count(frontier->points, true, &CostPoint::best), 1);
  for (const CostPoint& point : frontier->points) {
    EXPECT_GT(point.wall_s, 0) << point.knob;
    // The planner's reference is the reference itself: the same numbers.
    if (point.knob == "planner" && point.setting == "reference") {
      EXPECT_EQ(point.error_percent, 0);
    }
    // Draft draws have a standard error of 2 % and less; nothing is off by more than four of them and a few per cent.
    EXPECT_LT(point.error_percent, 15) << point.knob << " " << point.setting;
  }
}

}  // namespace
}  // namespace todbench
