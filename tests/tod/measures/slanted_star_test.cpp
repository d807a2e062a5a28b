// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/slanted_star.h"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/tod/measures/star_picture.h"

namespace todbench {
namespace {

using test::EdgePicture;
using test::StarPicture;
using ::testing::HasSubstr;

TEST(SlantedStar, FindsTheMtfAcrossEachEdge) {
  for (const double turn : {0.0, 7.0, 21.0, 33.0}) {
    StarPicture made;
    for (double& line : made.lines_deg) line += turn;

    const auto edges = slanted_star(made.picture(), {made.centre, made.radius}, {}).value();

    ASSERT_EQ(edges.size(), 8u);
    for (const StarEdge& edge : edges) {
      ASSERT_TRUE(edge.measured) << turn << ", " << edge.edge_deg << ": " << edge.rejected;
      EXPECT_NEAR(std::fmod(edge.edge_deg + 90, 180), edge.normal_deg, 0.3) << turn;
      const EdgePicture truth = made.edge_of(edge.normal_deg);
      for (std::size_t i = 0; i < edge.measured->mtf.size() && edge.measured->frequency_per_pitch[i] <= 0.5; ++i)
        EXPECT_NEAR(edge.measured->mtf[i], truth.mtf(edge.measured->frequency_per_pitch[i]), 0.001)
            << turn << ", " << edge.edge_deg;
    }
  }
}

// Of 8 edges over 20 seeds at four frequencies; neighbouring frequencies are not independent, so the tolerance is that
// of 160 edges: 0.95 - 3 sqrt(0.95 0.05 / 160).
TEST(SlantedStar, HasIntervalsThatHoldTheTruthInNoise) {
  const StarPicture made;
  int held = 0, all = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto edges = slanted_star(made.picture(0.01, seed), {made.centre, made.radius}, {}).value();
    for (const StarEdge& edge : edges) {
      ASSERT_TRUE(edge.measured) << seed << ", " << edge.edge_deg << ": " << edge.rejected;
      const EdgePicture truth = made.edge_of(edge.normal_deg);
      for (const std::size_t i : {10u, 20u, 30u, 50u}) {
        const double mtf = truth.mtf(edge.measured->frequency_per_pitch[i]);
        ++all;
        held += edge.measured->mtf_low[i] <= mtf && mtf <= edge.measured->mtf_high[i] ? 1 : 0;
      }
    }
  }
  EXPECT_EQ(all, 640);
  EXPECT_GT(held, 0.898 * all);
}

TEST(SlantedStar, NamesSagittalAndTangential) {
  StarPicture made;
  made.size = {400, 200};
  made.centre = {310.3, 99.6};

  const auto beside = slanted_star(made.picture(), {made.centre, made.radius}, {}).value();
  for (const StarEdge& edge : beside) {
    const double normal = edge.normal_deg > 90 ? 180 - edge.normal_deg : edge.normal_deg;
    const StarDirection expected = normal < 22.5   ? StarDirection::tangential
                                   : normal > 67.5 ? StarDirection::sagittal
                                                   : StarDirection::oblique;
    EXPECT_EQ(edge.direction, expected) << edge.normal_deg;
  }

  made.centre = {200.3, 99.6};
  const auto central = slanted_star(made.picture(), {made.centre, made.radius}, {}).value();
  for (const StarEdge& edge : central) EXPECT_EQ(edge.direction, StarDirection::central);
}

TEST(SlantedStar, RefusesPicturesWithoutAStar) {
  const StarPicture made;
  const cv::Mat1d picture = made.picture();
  const auto refused = [](const cv::Mat1d& of, StarPlace star) {
    const auto found = slanted_star(of, star, {});
    return found ? std::string() : found.error().message;
  };
  EXPECT_THAT(refused(picture, {made.centre, 20}), HasSubstr("at least 30 pixels"));
  EXPECT_THAT(refused(picture, {{40, 99}, 80}), HasSubstr("extends beyond the picture of 300 x 200 pixels"));
  EXPECT_THAT(refused(picture, {{NAN, 99}, 80}), HasSubstr("extends beyond"));
  EXPECT_THAT(refused(cv::Mat1d(200, 300, 0.5), {made.centre, 80}), HasSubstr("crosses 0 edges"));
  EXPECT_THAT(refused(EdgePicture{.edge_at_pitch = 100, .rows = 200, .columns = 200}.picture(), {{99, 99}, 80}),
              HasSubstr("crosses 2 edges"));
}

}  // namespace
}  // namespace todbench
