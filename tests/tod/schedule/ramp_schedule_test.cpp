// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/schedule/ramp_schedule.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace todbench {
namespace {

RampOptions ramp_of_eight_set_ups() {
  RampOptions ramp;
  ramp.stimuli.plates = {"a", "b"};
  ramp.stimuli.mountings.assign(all_mountings.begin(), all_mountings.end());
  ramp.stimuli.delta_t_k = {10, 1};
  ramp.stimuli.pixel_mm = 2;
  ramp.from_k = 10;
  ramp.to_k = 1;
  ramp.rate_k_per_s = 2;
  return ramp;
}

TEST(RampSchedule, TheRateAtTheBeginAndTheStepOfHalfASecondGiveItsLength) {
  const RampOptions ramp = ramp_of_eight_set_ups();

  // 2 K/s of 10 K: 0.2 per second; ln 10 / 0.2 = 11.5 s, 23 steps.
  EXPECT_EQ(ramp_steps(ramp), 24u);
  EXPECT_DOUBLE_EQ(ramp_relative_rate(ramp), 0.2);
}

TEST(RampSchedule, EverySetUpFallsFromTheFirstContrastToTheLastAndRisesAgain) {
  const RampOptions ramp = ramp_of_eight_set_ups();
  const std::size_t steps = ramp_steps(ramp);

  const auto states = ramp_presentations(ramp, RandomStream(1, "test"));

  ASSERT_EQ(states.size(), ramp_hold + 8 * 2 * steps);
  for (std::size_t i = ramp_hold; i < states.size(); ++i) {
    const std::size_t k = (i - ramp_hold) % (2 * steps);
    EXPECT_EQ(states[i].wait, k == 0 ? ContrastWait::within_band : ContrastWait::none) << i;
    EXPECT_EQ(states[i].point_delta_t_k, states[i].delta_t_k * states[i].delta_t_k > 10 ? 10 : 1) << i;
    const double ends[] = {k == 0 || k == 2 * steps - 1 ? 10.0 : 0, k == steps - 1 || k == steps ? 1.0 : 0};
    for (const double end : ends) EXPECT_TRUE(end == 0 || std::abs(states[i].delta_t_k - end) < 1e-9) << i;
    if (k == 0 || k == steps) continue;
    const double step = std::abs(std::log(states[i].delta_t_k / states[i - 1].delta_t_k));
    EXPECT_NEAR(step, 0.1, 2e-3) << i;
    EXPECT_EQ(states[i].delta_t_k < states[i - 1].delta_t_k, k < steps) << i;
  }
}

TEST(RampSchedule, TheFirstContrastIsHeldOnceWhereTheFirstRampBegins) {
  const RampOptions ramp = ramp_of_eight_set_ups();

  const auto states = ramp_presentations(ramp, RandomStream(1, "test"));

  for (std::size_t i = 0; i < ramp_hold; ++i) {
    EXPECT_EQ(states[i].wait, ContrastWait::held) << i;
    EXPECT_EQ(states[i].delta_t_k, 10) << i;
    EXPECT_EQ(states[i].point_delta_t_k, 10) << i;
    EXPECT_EQ(states[i].plate, states[ramp_hold].plate) << i;
    EXPECT_EQ(states[i].mounting, states[ramp_hold].mounting) << i;
    EXPECT_NE(states[i].shift_mm, states[i + 1].shift_mm) << i;
  }
  for (std::size_t i = ramp_hold; i < states.size(); ++i) EXPECT_NE(states[i].wait, ContrastWait::held) << i;
}

TEST(RampSchedule, ShiftsAreEvenOverEveryQuarterOfARamp) {
  const RampOptions ramp = ramp_of_eight_set_ups();
  const std::size_t steps = ramp_steps(ramp), quarter = steps / 4;

  auto states = ramp_presentations(ramp, RandomStream(1, "test"));
  states.erase(states.begin(), states.begin() + ramp_hold);

  // Of six independent phases, the length of the mean vector exp(2 pi i x) is 1 / sqrt(6) = 0.41 in the root mean
  // square; the additive recurrence stays below it in every stretch.
  for (std::size_t first = 0; first + quarter <= 2 * steps; first += quarter) {
    double re = 0, im = 0;
    for (std::size_t i = first; i < first + quarter; ++i) {
      const double turn = 2 * std::numbers::pi * states[i].shift_mm.x / ramp.stimuli.pixel_mm;
      re += std::cos(turn) / static_cast<double>(quarter);
      im += std::sin(turn) / static_cast<double>(quarter);
    }
    EXPECT_LT(std::hypot(re, im), 0.3) << first;
  }
}

TEST(RampSchedule, TheLowEndIsShownAgainUntilTheCameraSeesItsContrast) {
  const RampOptions ramp = ramp_of_eight_set_ups();
  RampSchedule schedule(ramp, RandomStream(1, "test"));
  double body_k = 10;  // of first order, 3 s
  std::vector<TargetState> shown;

  while (const auto state = schedule.next()) {
    body_k = state->delta_t_k + (body_k - state->delta_t_k) * std::exp(-ramp_step_s / 3);
    Trial trial;
    trial.delta_t_k = body_k;
    schedule.observe(std::vector{trial});
    shown.push_back(*state);
  }

  const std::size_t again = shown.size() - ramp_hold - 16 * ramp_steps(ramp);
  // In equilibrium the body is 1 / (1 - 0.2 x 3) = 2.5 times as warm as its set-point; from 2.5 to 1.1 K it takes
  // 3 ln(1.5 / 0.1) = 8.1 s, 16 presentations, in each of eight set-ups.
  EXPECT_NEAR(static_cast<double>(again), 8 * 16, 16);
  EXPECT_EQ(schedule.planned(), shown.size());
  for (std::size_t i = 1; i < shown.size(); ++i) EXPECT_NE(shown[i].shift_mm, shown[i - 1].shift_mm) << i;
}

TEST(RampSchedule, ATargetThatNeverArrivesEndsTheRamp) {
  const RampOptions ramp = ramp_of_eight_set_ups();
  RampSchedule schedule(ramp, RandomStream(1, "test"));
  std::size_t shown = 0;

  while (const auto state = schedule.next()) {
    Trial trial;
    trial.delta_t_k = 10;
    schedule.observe(std::vector{trial});
    ++shown;
  }

  EXPECT_EQ(shown, ramp_hold + 8 * 5 * ramp_steps(ramp));
}

}  // namespace
}  // namespace todbench
