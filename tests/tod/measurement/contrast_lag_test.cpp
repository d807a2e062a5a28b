// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measurement/contrast_lag.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "acquisition/base/rng.h"
#include "tod/schedule/ramp_schedule.h"

namespace todbench {
namespace {

/// Errors of the contrasts of a presentation, and lags that differ between ramps down and up.
struct LaggingPlate {
  double lag_down_s = 0, lag_up_s = 0;
  double factor = 0.97;       ///< of the small triangles
  double pattern_k = 0.02;    ///< standard deviation over set-ups, of the small triangles
  double relative_error = 0;  ///< of both contrasts
  double error_k = 0;         ///< of both contrasts
  std::uint64_t seed = 1;
};

RampOptions ramp_of_20_s() {
  RampOptions ramp;
  ramp.stimuli.plates = {"a", "b"};
  ramp.stimuli.mountings.assign(all_mountings.begin(), all_mountings.end());
  ramp.stimuli.delta_t_k = {10, 1};
  ramp.stimuli.pixel_mm = 2;
  ramp.from_k = 16.9;
  ramp.to_k = 0.23;
  ramp.rate_k_per_s = 3.6;
  return ramp;
}

std::vector<Presentation> presentations_of(const LaggingPlate& plate, const RampOptions& ramp) {
  const auto states = ramp_presentations(ramp, RandomStream(plate.seed, "schedule"));
  const RandomStream random(plate.seed, "test.lag");
  std::uint64_t draw = 0;
  std::vector<Presentation> out;
  std::string plate_before;
  Mounting mounting_before = Mounting::identity;
  double pattern_k = 0;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const TargetState& state = states[i];
    if (i == 0 || state.plate != plate_before || state.mounting != mounting_before)
      pattern_k = plate.pattern_k * random.normal(draw++);
    plate_before = state.plate, mounting_before = state.mounting;
    const bool last = i + 1 == states.size() || states[i + 1].mounting != state.mounting;
    const double next_k = last ? state.delta_t_k : states[i + 1].delta_t_k;
    const bool held = state.wait == ContrastWait::held, down = next_k < state.delta_t_k;
    const double rate = held ? 0 : (down ? -1 : 1) * ramp_relative_rate(ramp);
    const double small_k = state.delta_t_k * std::exp(-rate * (down ? plate.lag_down_s : plate.lag_up_s));
    const auto error = [&](double k) {
      const double relative = plate.relative_error * k * random.normal(draw++);
      return relative + plate.error_k * random.normal(draw++);
    };
    Presentation shown;
    shown.presentation = static_cast<std::int64_t>(i);
    shown.set = state;
    shown.delta_t_k = state.delta_t_k + error(state.delta_t_k);
    shown.small_delta_t_k = plate.factor * small_k + pattern_k + error(small_k);
    out.push_back(shown);
  }
  return out;
}

TEST(ContrastLag, IsThatOfThePlate) {
  const LaggingPlate plate{.lag_down_s = 0.1, .lag_up_s = 0.1};

  const auto lag = contrast_lag(presentations_of(plate, ramp_of_20_s()), ramp_step_s);

  // The rate between the neighbours of a presentation is 0.2 % too large, and the exponential bends by 1 %.
  ASSERT_TRUE(lag && lag->down && lag->up);
  EXPECT_NEAR(lag->all.lag_s, 0.1, 2e-3);
  EXPECT_NEAR(lag->down->lag_s, 0.1, 3e-3);
  EXPECT_NEAR(lag->up->lag_s, 0.1, 3e-3);
  EXPECT_TRUE(lag->all.exceeds(0.03));
}

TEST(ContrastLag, OnlyTheHeldContrastShowsALagOfOppositeSigns) {
  const LaggingPlate plate{.lag_down_s = 0.1, .lag_up_s = -0.1};
  auto presentations = presentations_of(plate, ramp_of_20_s());

  const auto held = contrast_lag(presentations, ramp_step_s);
  presentations.erase(presentations.begin(), presentations.begin() + ramp_hold);
  const auto not_held = contrast_lag(presentations, ramp_step_s);

  ASSERT_TRUE(held && held->down && held->up && not_held);
  EXPECT_NEAR(held->down->lag_s, 0.1, 3e-3);
  EXPECT_NEAR(held->up->lag_s, -0.1, 3e-3);
  EXPECT_NEAR(not_held->all.lag_s, 0, 3e-3);
  EXPECT_FALSE(not_held->down || not_held->up);
}

TEST(ContrastLag, RightRunsPassAndALagBeyondTheStatedOneIsFound) {
  constexpr int runs = 2000;
  int false_alarms = 0, found = 0;
  for (std::uint64_t seed = 1; seed <= runs; ++seed) {
    LaggingPlate plate{.relative_error = 0.005, .error_k = 0.01, .seed = seed};
    plate.lag_down_s = plate.lag_up_s = 0.03;
    const auto any = [&](double stated_s) {
      const auto lag = contrast_lag(presentations_of(plate, ramp_of_20_s()), ramp_step_s);
      return lag->all.exceeds(stated_s) || lag->down->exceeds(stated_s) || lag->up->exceeds(stated_s);
    };
    false_alarms += any(0.03) ? 1 : 0;
    if (seed > 200) continue;
    plate.lag_down_s = plate.lag_up_s = 0.1;
    found += any(0.03) ? 1 : 0;
  }
  // The stated lag is reached from one side only: at most 0.5 % are expected; 1 % and three standard errors.
  EXPECT_LE(false_alarms, 0.01 * runs + 3 * std::sqrt(0.01 * runs));
  EXPECT_GE(found, 198);
}

TEST(ContrastLag, IsUnknownWithoutContrasts) {
  auto presentations = presentations_of({}, ramp_of_20_s());
  for (Presentation& shown : presentations) shown.small_delta_t_k.reset();

  EXPECT_FALSE(contrast_lag(presentations, ramp_step_s));
}

}  // namespace
}  // namespace todbench
