// SPDX-License-Identifier: GPL-3.0-or-later
// The estimate without frames over noise from a hundredth of a count to thirty.
#include <gtest/gtest.h>

#include "tests/sim_devices/prediction/brute_force.h"

namespace todbench {
namespace {

TEST(RoundingStudy, TheEstimateIsWhatTrialsSayFromAHundredthOfACountToThirty) {
  TemplateObserver observer({}, triangle_alternatives());
  for (const double noise : {0.01, 0.1, 0.3, 0.5}) {
    for (const double contrast : {0.6, 1.5, 4.3, 20.0})
      test::expect_estimate_is_what_trials_say({noise, contrast}, observer, 16);
  }
  // Contrasts of 1.5 times the noise and more have a threshold.
  for (const double noise : {1.0, 3.0, 30.0}) {
    for (const double over_noise : {2.0, 6.0, 30.0})
      test::expect_estimate_is_what_trials_say({noise, noise * over_noise}, observer, 16);
  }
}

}  // namespace
}  // namespace todbench
