// SPDX-License-Identifier: GPL-3.0-or-later
// Thresholds of simulated people, whose functions are known.
#include "tod/measures/forced_choice.h"

#include <gmock/gmock.h>

#include <cmath>
#include <vector>

#include "tests/tod/measures/simulated_choices.h"

namespace todbench {
namespace {

using testing::choices_of;
using ::testing::HasSubstr;
using testing::SimulatedChooser;

TEST(ForcedChoiceThreshold, IsHeldByItsIntervalForPeopleWithPhasesLapsesAndAnOffset) {
  // Steep and flat functions, with lapses, and thresholds that differ by 20 % (sd) between set-ups.
  for (const SimulatedChooser& person : {SimulatedChooser{}, {.exponent = 3, .lapse = 0.04}, {.set_up_sd = 0.2}}) {
    int within = 0, found = 0;
    double bias = 0;
    constexpr int seeds = 30;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      const auto threshold = forced_choice_threshold(choices_of(person, seed));
      if (!threshold.half_k) continue;
      ++found;
      within += *threshold.ci95.low <= person.threshold_k && person.threshold_k <= *threshold.ci95.high ? 1 : 0;
      bias += std::log(*threshold.half_k / person.threshold_k);
    }
    EXPECT_EQ(found, seeds);
    // 95 % of 30 with a standard deviation of 1.2.
    EXPECT_GE(within, 25) << person.exponent << " " << person.set_up_sd;
    EXPECT_LT(std::abs(bias / found), 0.15) << person.exponent << " " << person.set_up_sd;
  }
}

TEST(ForcedChoiceThreshold, DoesNotContainTheOffsetOfTheTarget) {
  double sum = 0, difference = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto found = forced_choice_threshold(choices_of({.offset_k = 0.008}, seed));
    ASSERT_TRUE(found.half_k) << found.reason;
    sum += *found.half_k / 20;
    difference += 0.5 * (*found.positive_k + *found.negative_k) / 20;
  }
  EXPECT_NEAR(sum, 0.03, 0.004);
  EXPECT_NEAR(difference, -0.008, 0.004);
}

TEST(ForcedChoiceThreshold, IsRefusedForGuessersAndThresholdsOutsideTheContrasts) {
  int accepted = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed)
    accepted += forced_choice_threshold(choices_of({.threshold_k = 1e9}, seed)).half_k ? 1 : 0;
  EXPECT_LE(accepted, 2);
  EXPECT_THAT(forced_choice_threshold(choices_of({.threshold_k = 0.001}, 1)).reason, HasSubstr("above the threshold"));
  EXPECT_THAT(forced_choice_threshold(choices_of({.threshold_k = 1e9}, 1)).reason, HasSubstr("guessing"));
  // A person who sees one polarity only.
  auto one_sided = choices_of({}, 1);
  for (const ForcedChoice& blind : choices_of({.threshold_k = 1e9}, 2)) {
    for (ForcedChoice& one : one_sided) {
      if (one.contrast_k < 0 && one.contrast_k == blind.contrast_k && one.set_up == blind.set_up) one = blind;
    }
  }
  EXPECT_FALSE(forced_choice_threshold(one_sided).half_k);
  auto few = choices_of({}, 1);
  few.resize(30);
  EXPECT_THAT(forced_choice_threshold(few).reason, HasSubstr("a threshold needs"));
  EXPECT_THAT(forced_choice_threshold({}).reason, HasSubstr("0 answers"));
}

}  // namespace
}  // namespace todbench
