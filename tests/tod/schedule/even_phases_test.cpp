// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/schedule/even_phases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>
#include <string>

#include "tests/tod/registration/plate_picture.h"
#include "tod/schedule/schedule.h"

namespace todbench {
namespace {

/// Wrap-around L2 discrepancy of points on the unit torus (Hickernell 1998); integer parts do not count. The root mean
/// square for n independent points is 0.687 / sqrt(n). Precondition: not empty.
double wraparound_discrepancy(std::span<const cv::Point2d> points) {
  const auto kernel = [](double difference) {
    const double x = difference - std::floor(difference);
    return 1.5 - x * (1 - x);
  };
  double sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j)
      sum += 2 * kernel(points[i].x - points[j].x) * kernel(points[i].y - points[j].y);
    sum += 1.5 * 1.5;
  }
  const auto n = static_cast<double>(points.size());
  return std::sqrt(std::max(0.0, sum / (n * n) - 16.0 / 9));
}

ConstantStimuliOptions demonstration(int phases) {
  ConstantStimuliOptions options;
  options.drawings = {testing::shipped_plate("tcat-a"), testing::shipped_plate("tcat-b")};
  options.plates = {"tcat-a", "tcat-b"};
  options.mountings = {all_mountings.begin(), all_mountings.end()};
  options.delta_t_k = {16.9};
  options.phases = phases;
  options.pixel_mm = 2.617;
  return options;
}

/// Every set-up with a lattice of its own, from a random place.
std::vector<TargetState> apart(const ConstantStimuliOptions& options, std::uint64_t seed) {
  std::vector<TargetState> states = constant_stimuli(options, RandomStream(seed, "schedule"));
  std::map<std::pair<std::string, Mounting>, std::vector<cv::Point2d>> phases;
  std::map<std::pair<std::string, Mounting>, std::size_t> next;
  for (TargetState& state : states) {
    const std::pair set_up{state.plate, state.mounting};
    if (!phases.contains(set_up)) {
      const auto number = static_cast<std::uint64_t>(phases.size());
      phases[set_up] = spread_phases(options.phases, RandomStream(seed, "apart").sub(number));
    }
    state.shift_mm = options.pixel_mm * phases[set_up][next[set_up]++];
  }
  return states;
}

/// Root mean square over the sizes of the discrepancy of the phases that triangles of one size see; of those that
/// point alike, too.
struct Evenness {
  double of_sizes = 0, of_orientations = 0;
};

Evenness evenness(const std::vector<TargetState>& states, const ConstantStimuliOptions& options) {
  std::map<double, std::vector<cv::Point2d>> sizes;
  std::map<std::pair<double, Apex>, std::vector<cv::Point2d>> orientations;
  for (const TargetState& state : states) {
    const auto plate = std::ranges::find(options.drawings, state.plate, &TargetPlate::name);
    const TargetPlate held = mounted(*plate, state.mounting);
    for (const PlateTriangle& t : held.triangles) {
      const cv::Point2d phase = (t.position_mm + state.shift_mm) / options.pixel_mm;
      sizes[t.size_mm].push_back(phase);
      orientations[{t.size_mm, t.apex}].push_back(phase);
    }
  }
  const auto mean = [](const auto& sets) {
    double squares = 0;
    for (const auto& [key, points] : sets) squares += std::pow(wraparound_discrepancy(points), 2);
    return std::sqrt(squares / static_cast<double>(sets.size()));
  };
  return {mean(sizes), mean(orientations)};
}

TEST(EvenPhases, DiscrepancyIsThatOfItsFourierSeries) {
  const std::vector<cv::Point2d> points{{0.1, 0.7}, {1.45, -0.2}, {0.9, 0.31}, {0.33, 0.33}};
  double series = 0;
  constexpr int reach = 60;
  const auto weight = [](int k) {
    return k == 0 ? 4.0 / 3 : 1 / (2 * std::numbers::pi * std::numbers::pi * static_cast<double>(k) * k);
  };
  for (int h = -reach; h <= reach; ++h) {
    for (int k = -reach; k <= reach; ++k) {
      if (h == 0 && k == 0) continue;
      std::complex<double> sum = 0;
      for (const cv::Point2d& p : points) sum += std::polar(0.25, 2 * std::numbers::pi * (h * p.x + k * p.y));
      series += weight(h) * weight(k) * std::norm(sum);
    }
  }

  // What is left out of the series: at most 2 * 4/3 * 2 sum_{k > 60} 1 / (2 pi^2 k^2) = 0.0045.
  EXPECT_NEAR(std::pow(wraparound_discrepancy(points), 2), series, 0.005);
}

TEST(EvenPhases, ShiftsOfAGroupHaveNoLowHarmonics) {
  for (const int count : {2, 3, 4, 7, 12, 16, 30, 61}) {
    const EvenPhases phases = even_phases({}, 1, count);
    ASSERT_EQ(phases.shifts[0].size(), static_cast<std::size_t>(count));
    // A lattice of n points has a dual vector no longer than sqrt(2 n / sqrt(3)); the best one comes near.
    const double reach = least_harmonic(count) - 1e-9;
    EXPECT_GE(reach, 0.75 * std::sqrt(2 * count / std::sqrt(3.0)));
    for (int h = -20; h <= 20; ++h) {
      for (int k = -20; k <= 20; ++k) {
        if ((h == 0 && k == 0) || std::hypot(h, k) >= reach) continue;
        std::complex<double> sum = 0;
        for (const cv::Point2d& p : phases.shifts[0]) {
          EXPECT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
          sum += std::polar(1.0, 2 * std::numbers::pi * (h * p.x + k * p.y));
        }
        EXPECT_NEAR(std::abs(sum), 0, 1e-9) << count << ": " << h << " " << k;
      }
    }
  }
}

TEST(EvenPhases, BeginningsOfAGroupAreMoreEvenThanRandomPoints) {
  const EvenPhases phases = even_phases({}, 1, 16);
  for (const std::size_t some : {4U, 8U, 12U}) {
    const std::span beginning(phases.shifts[0].data(), some);
    EXPECT_LT(wraparound_discrepancy(beginning), 0.75 * 0.687 / std::sqrt(some)) << some;
  }
}

TEST(EvenPhases, EverySizeSeesItsPhasesMoreEvenlyThanWithSetUpsApart) {
  struct Case {
    int phases = 0;
    double sizes = 0, orientations = 0;  ///< at most this part of the discrepancy with set-ups apart
  };
  for (const Case& c : {Case{1, 0.75, 0.93}, Case{3, 0.65, 0.85}, Case{12, 0.75, 0.93}, Case{16, 0.75, 0.93}}) {
    const ConstantStimuliOptions options = demonstration(c.phases);
    const Evenness together = evenness(constant_stimuli(options, RandomStream(1, "schedule")), options);
    Evenness before;
    constexpr int seeds = 6;
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
      const Evenness found = evenness(apart(options, seed), options);
      before.of_sizes += found.of_sizes / seeds;
      before.of_orientations += found.of_orientations / seeds;
    }
    RecordProperty("before_" + std::to_string(c.phases), std::to_string(before.of_sizes));
    RecordProperty("together_" + std::to_string(c.phases), std::to_string(together.of_sizes));

    EXPECT_LT(together.of_sizes, c.sizes * before.of_sizes) << c.phases;
    EXPECT_LT(together.of_orientations, c.orientations * before.of_orientations) << c.phases;
  }
}

TEST(EvenPhases, StayEvenWhereverThePlateIsAndForAPixelOnePercentOff) {
  ConstantStimuliOptions options = demonstration(12);
  const std::vector<TargetState> states = constant_stimuli(options, RandomStream(1, "schedule"));
  const double even = evenness(states, options).of_sizes;
  for (PlateTriangle& t : options.drawings[0].triangles) t.position_mm += cv::Point2d(0.31, 0.77);
  for (PlateTriangle& t : options.drawings[1].triangles) t.position_mm += cv::Point2d(0.31, 0.77);
  ConstantStimuliOptions wide = demonstration(12);
  wide.pixel_mm *= 1.01;

  // Mountings turn a displacement of the plate with it: the shifts of a mounting stay even, how they fit does not.
  EXPECT_LT(evenness(states, options).of_sizes, 2 * even);
  EXPECT_LT(evenness(states, wide).of_sizes, 2 * even);
}

TEST(EvenPhases, AreChosenForEveryNestingOfTheLoops) {
  ConstantStimuliOptions options = demonstration(4);
  for (const auto& costs :
       {std::array{1.0, 2.0, 3.0, 4.0}, std::array{5.0, 1.0, 1.0, 3.0}, std::array{1.0, 5.0, 6.0, 4.0}}) {
    std::ranges::copy(costs, options.change_cost_s);
    const std::vector<TargetState> states = constant_stimuli(options, RandomStream(1, "schedule"));
    std::map<std::pair<std::string, Mounting>, std::vector<cv::Point2d>> phases;
    for (const TargetState& state : states)
      phases[{state.plate, state.mounting}].push_back(state.shift_mm / options.pixel_mm);

    ASSERT_EQ(phases.size(), 8U);
    const double of_lattice = wraparound_discrepancy(even_phases({}, 1, 4).shifts[0]);
    for (const auto& [set_up, points] : phases) {
      ASSERT_EQ(points.size(), 4U);
      EXPECT_NEAR(wraparound_discrepancy(points), of_lattice, 1e-9);
    }
  }
}

}  // namespace
}  // namespace todbench
