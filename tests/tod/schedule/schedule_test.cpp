// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/schedule/schedule.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

namespace todbench {
namespace {

/// Star discrepancy of points in the unit square: the largest difference between the share of points in a box from the
/// origin and its area. The supremum is reached at corners made of point coordinates, with the border counted or not
/// (Niederreiter 1992, section 2.1).
double star_discrepancy(const std::vector<cv::Point2d>& points) {
  std::vector<double> xs{1}, ys{1};
  for (const cv::Point2d& p : points) {
    xs.push_back(p.x);
    ys.push_back(p.y);
  }
  double worst = 0;
  for (const double x : xs) {
    for (const double y : ys) {
      int closed = 0, open = 0;
      for (const cv::Point2d& p : points) {
        closed += p.x <= x && p.y <= y;
        open += p.x < x && p.y < y;
      }
      const double n = static_cast<double>(points.size());
      worst = std::max({worst, closed / n - x * y, x * y - open / n});
    }
  }
  return worst;
}

double mean_discrepancy_of_random_points(int count) {
  double sum = 0;
  constexpr int repetitions = 40;
  for (std::uint64_t k = 0; k < repetitions; ++k) {
    const RandomStream random(k, "test.points");
    std::vector<cv::Point2d> points;
    for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(count); ++i) {
      points.emplace_back(random.uniform(2 * i), random.uniform(2 * i + 1));
    }
    sum += star_discrepancy(points) / repetitions;
  }
  return sum;
}

ConstantStimuliOptions two_of_everything() {
  ConstantStimuliOptions options;
  options.plates = {"a", "b"};
  options.mountings = {Mounting::identity, Mounting::rotated_180};
  options.delta_t_k = {0.23, 16.9, -1.93};
  options.phases = 4;
  options.pixel_mm = 2.617;
  return options;
}

struct Changes {
  int plate = 0, mounting = 0, contrast = 0, shift = 0;
};

Changes changes(const std::vector<TargetState>& states) {
  Changes count;
  for (std::size_t i = 1; i < states.size(); ++i) {
    count.plate += states[i].plate != states[i - 1].plate;
    count.mounting += states[i].mounting != states[i - 1].mounting;
    count.contrast += states[i].delta_t_k != states[i - 1].delta_t_k;
    count.shift += states[i].shift_mm != states[i - 1].shift_mm;
  }
  return count;
}

std::vector<TargetState> with_costs(double plate, double mounting, double contrast, double shift) {
  ConstantStimuliOptions options = two_of_everything();
  const double costs[] = {plate, mounting, contrast, shift};
  std::ranges::copy(costs, options.change_cost_s);
  return constant_stimuli(options, RandomStream(5, "schedule"));
}

TEST(SpreadPhases, LieInTheUnitSquareAndAreAllDifferent) {
  const auto phases = spread_phases(64, RandomStream(1, "phases"));

  std::set<std::pair<double, double>> distinct;
  for (const cv::Point2d& p : phases) {
    EXPECT_GE(p.x, 0);
    EXPECT_LT(p.x, 1);
    EXPECT_GE(p.y, 0);
    EXPECT_LT(p.y, 1);
    distinct.insert({p.x, p.y});
  }
  EXPECT_EQ(distinct.size(), 64U);
}

TEST(SpreadPhases, AreMoreEvenThanRandomOnesForEveryCountAndStart) {
  // Random points have a star discrepancy near 0.8 / sqrt(n) with a scatter of about a quarter of it; an additive
  // recurrence has O(log^2 n / n). Mean over ten starts against the mean over forty random sets: from five points on
  // the gap is many standard errors.
  for (const int count : {5, 7, 10, 13, 16, 20, 31, 50}) {
    double mean = 0;
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      mean += star_discrepancy(spread_phases(count, RandomStream(seed, "phases"))) / 10;
    }

    EXPECT_LT(mean, 0.85 * mean_discrepancy_of_random_points(count)) << count;
  }
}

TEST(SpreadPhases, AShorterListIsTheBeginningOfALongerOne) {
  const auto few = spread_phases(5, RandomStream(3, "phases"));
  const auto many = spread_phases(12, RandomStream(3, "phases"));

  EXPECT_TRUE(std::equal(few.begin(), few.end(), many.begin()));
}

TEST(SpreadPhases, StartWhereTheStreamSays) {
  EXPECT_EQ(spread_phases(3, RandomStream(3, "phases")), spread_phases(3, RandomStream(3, "phases")));
  EXPECT_NE(spread_phases(1, RandomStream(3, "phases")), spread_phases(1, RandomStream(4, "phases")));
  EXPECT_TRUE(spread_phases(0, RandomStream(3, "phases")).empty());
}

TEST(ConstantStimuli, ShowEveryCombinationInEveryPhaseExactlyOnce) {
  for (const auto& states : {with_costs(60, 30, 20, 0.1), with_costs(1, 2, 3, 4), with_costs(5, 1, 1, 3)}) {
    std::map<std::tuple<std::string, Mounting, double>, std::set<std::pair<double, double>>> shown;
    for (const TargetState& s : states) {
      shown[{s.plate, s.mounting, s.delta_t_k}].insert({s.shift_mm.x, s.shift_mm.y});
    }

    EXPECT_EQ(states.size(), 2U * 2U * 3U * 4U);
    EXPECT_EQ(shown.size(), 2U * 2U * 3U);
    for (const auto& [combination, shifts] : shown) EXPECT_EQ(shifts.size(), 4U);
  }
}

TEST(ConstantStimuli, WhatTakesLongestToChangeChangesLeastOften) {
  const Changes plates_first = changes(with_costs(60, 30, 20, 0.1));
  EXPECT_EQ(plates_first.plate, 1);
  EXPECT_EQ(plates_first.mounting, 3);
  EXPECT_EQ(plates_first.contrast, 11);

  const Changes contrasts_first = changes(with_costs(10, 20, 600, 0.1));
  EXPECT_EQ(contrasts_first.contrast, 2);
  EXPECT_EQ(contrasts_first.mounting, 5);
  EXPECT_EQ(contrasts_first.plate, 11);

  const Changes shifts_first = changes(with_costs(3, 2, 1, 90));
  EXPECT_EQ(shifts_first.shift, 3);
  EXPECT_EQ(shifts_first.plate, 7);
  EXPECT_EQ(shifts_first.mounting, 15);
  EXPECT_EQ(shifts_first.contrast, 47);
}

TEST(ConstantStimuli, EqualCostsKeepTheOrderPlateMountingContrastShift) {
  EXPECT_EQ(with_costs(7, 7, 7, 7), with_costs(4, 3, 2, 1));
}

TEST(ConstantStimuli, TheHighestContrastOfEitherSignComesFirstInEverySetUp) {
  for (const auto& states : {with_costs(60, 30, 20, 0.1), with_costs(10, 20, 600, 0.1), with_costs(3, 2, 1, 90)}) {
    std::map<std::pair<std::string, Mounting>, std::vector<double>> contrasts;
    for (const TargetState& s : states) {
      auto& list = contrasts[{s.plate, s.mounting}];
      if (std::ranges::find(list, s.delta_t_k) == list.end()) list.push_back(s.delta_t_k);
    }

    EXPECT_EQ(contrasts.size(), 4U);
    for (const auto& [set_up, list] : contrasts) EXPECT_EQ(list, (std::vector<double>{16.9, -1.93, 0.23}));
  }
}

TEST(ConstantStimuli, SetUpsAndContrastsHavePhasesOfTheirOwnWhereShiftsAreCheap) {
  std::set<std::pair<double, double>> shifts;
  for (const TargetState& s : with_costs(60, 30, 20, 0.1)) {
    EXPECT_GE(s.shift_mm.x, 0);
    EXPECT_LT(s.shift_mm.x, 2.617);
    EXPECT_GE(s.shift_mm.y, 0);
    EXPECT_LT(s.shift_mm.y, 2.617);
    shifts.insert({s.shift_mm.x, s.shift_mm.y});
  }

  EXPECT_EQ(shifts.size(), 48U);
}

TEST(ListedSchedule, GivesItsListOnceInOrder) {
  const auto states = with_costs(60, 30, 20, 0.1);
  ListedSchedule schedule(states);

  std::vector<TargetState> shown;
  while (const auto state = schedule.next()) shown.push_back(*state);

  EXPECT_EQ(shown, states);
  EXPECT_EQ(schedule.planned(), states.size());
  EXPECT_FALSE(schedule.next().has_value());
}

}  // namespace
}  // namespace todbench
