// SPDX-License-Identifier: GPL-3.0-or-later
// Plans with a display, and observers with an eye.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bench/plan/descriptions.h"
#include "bench/plan/loaded_plan.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;

constexpr const char* display =
    "[display]\npixel_pitch_mm = 0.25\nviewing_distance_m = 0.6\nluminance_white_cd_m2 = 100\nzoom = 2\n";

Result<LoadedPlan> plan_with(const std::string& more) {
  return read_plan({.origin = "p.toml",
                    .text = "[target]\ndistance_m = 2\nplates = [\"tcat-a\"]\ndelta_t_k = [16.9, 1.93]\n" + more},
                   "");
}

std::string refusal(const std::string& more) {
  const auto loaded = plan_with("[observer]\nname = \"hvs-2\"\n" + more);
  if (loaded) return "";
  EXPECT_EQ(loaded.error().code, ErrorCode::invalid_input);
  return loaded.error().message;
}

TEST(DisplayKeys, GiveTheObserverItsDisplay) {
  const auto loaded = plan_with(std::string("[observer]\nname = \"hvs-2\"\n") + display);

  ASSERT_TRUE(loaded) << loaded.error().message;
  ASSERT_TRUE(loaded->observer().eye);
  ASSERT_TRUE(loaded->observer().display);
  EXPECT_EQ(loaded->observer().display->zoom, 2);
  EXPECT_EQ(loaded->observer().eye->sensitivity, 1202);
  EXPECT_EQ(loaded->observer().sensor_noise_factor, 1.75);
  EXPECT_TRUE(validate(loaded->observer()));
}

TEST(DisplayKeys, AreWrittenWithTheResolvedPlan) {
  const auto loaded = plan_with(std::string("[observer]\nname = \"hvs-2\"\n") + display +
                                "interpolation = \"linear\"\nspot_mm = 0.1\n");
  ASSERT_TRUE(loaded) << loaded.error().message;

  const auto again = parse_plan({.origin = "again.toml", .text = to_toml(loaded->plan())}, "");

  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(*again, loaded->plan());
  EXPECT_THAT(to_toml(loaded->plan()), HasSubstr("viewing_distance_m = 0.6"));
}

TEST(DisplayKeys, AreNotWrittenIfNotStated) {
  const auto loaded = plan_with("");

  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_THAT(to_toml(loaded->plan()), ::testing::Not(HasSubstr("[display]")));
  EXPECT_FALSE(loaded->observer().display);
}

TEST(DisplayKeys, AreNotGivenToAnObserverWithoutAnEye) {
  const auto loaded = plan_with(display);

  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_FALSE(loaded->observer().display);
}

TEST(DisplayKeys, AreRefusedInOneSentence) {
  EXPECT_THAT(refusal(""), HasSubstr("observer hvs-2 has an eye and needs a display"));
  EXPECT_THAT(refusal("[display]\npixel_pitch_mm = 0.25\nviewing_distance_m = 600\nluminance_white_cd_m2 = 100\n"),
              HasSubstr("state 0.6 for 600 mm"));
  EXPECT_THAT(refusal("[display]\npixel_pitch_mm = 0.25\nviewing_distance_m = 0.6\nluminance_white_cd_m2 = 0\n"),
              HasSubstr("a white of 0 cd/m2"));
  EXPECT_THAT(refusal("[display]\npixel_pitch_mm = 0.25\nviewing_distance_m = 0.6\nluminance_table = [0, 50, 40]\n"),
              HasSubstr("the luminance falls from 50 to 40 cd/m2 at value 3"));
  EXPECT_THAT(refusal(std::string(display) + "span_k = 20\n"), HasSubstr("a contrast of 16.9 K cannot be shown"));
  EXPECT_THAT(refusal(std::string(display) + "veil_cd_m2 = 200\n"), HasSubstr("the display cannot show"));
  EXPECT_THAT(refusal(std::string(display) + "viewing_distance_mm = 600\n"), HasSubstr("viewing_distance_mm"));
}

TEST(DisplayKeys, BelongToPlansAlone) {
  const auto alone = load_observer("hvs-2");

  ASSERT_FALSE(alone);
  EXPECT_THAT(alone.error().message, HasSubstr("needs a display, which this command does not have"));
}

}  // namespace
}  // namespace todbench
