// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measurement/stage_fit.h"

#include <gmock/gmock.h>

#include <functional>
#include <utility>
#include <vector>

#include "acquisition/base/rng.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;

/// Twelve shifts over a pixel, and where `move` brings the plate, seen with an error of 0.02 px.
std::vector<ShiftSeen> seen_where(const std::function<cv::Point2d(cv::Point2d, int)>& move) {
  std::vector<ShiftSeen> places;
  const RandomStream noise(1, "stage");
  for (int k = 0; k < 12; ++k) {
    const cv::Point2d asked((k * 5 % 12) / 12.0, (k * 7 % 12) / 12.0);
    const auto index = static_cast<std::uint64_t>(2 * k);
    const cv::Point2d error(0.02 * static_cast<double>(noise.normal(index)),
                            0.02 * static_cast<double>(noise.normal(index + 1)));
    places.push_back({.presentation = k,
                      .asked_px = asked,
                      .off_px = move(asked, k) - asked + error,
                      .standard_error_px = {0.02, 0.02}});
  }
  return places;
}

TEST(StageFit, NamesTheCauseOfPlacesThatAreNotThoseAskedFor) {
  const auto cause = [](auto move) { return likely_cause(seen_where(move)); };

  EXPECT_THAT(cause([](cv::Point2d a, int) { return cv::Point2d(-a.x, a.y); }),
              HasSubstr("along x with the wrong sign"));
  EXPECT_THAT(cause([](cv::Point2d a, int) { return cv::Point2d(a.x, -a.y); }),
              HasSubstr("along y with the wrong sign"));
  EXPECT_THAT(cause([](cv::Point2d a, int) { return cv::Point2d(a.y, a.x); }),
              HasSubstr("axes of the stage are exchanged"));
  EXPECT_THAT(cause([](cv::Point2d, int) { return cv::Point2d(0.3, 0.3); }), HasSubstr("the stage does not move"));
  EXPECT_THAT(cause([](cv::Point2d a, int) { return 0.6 * a; }), HasSubstr("times the requested shift along x and by"));
  EXPECT_THAT(cause([](cv::Point2d a, int k) { return a + cv::Point2d(k < 7 ? 0 : 2, 0); }),
              HasSubstr("px between presentations 6 and 7"));
}

TEST(StageFit, NamesPicturesThatComeLate) {
  cv::Point2d before(0, 0);
  const auto late = [&](cv::Point2d a, int) { return std::exchange(before, a); };
  EXPECT_THAT(likely_cause(seen_where(late)), HasSubstr("pictures arrive later than"));
}

TEST(StageFit, NamesPlayOfTheStage) {
  double last = 0, side = 0;
  const auto play = [&](cv::Point2d a, int) {
    if (a.x != last) side = a.x > last ? -0.2 : 0.2;
    last = a.x;
    return a + cv::Point2d(side, 0);
  };
  EXPECT_THAT(likely_cause(seen_where(play)), HasSubstr("play: 0.4"));
}

TEST(StageFit, MeasuresTheMovementOfARightStageAsTheUnitMatrix) {
  const auto fit = fit_stage(seen_where([](cv::Point2d a, int) { return a; }));

  ASSERT_TRUE(fit.has_value());
  // Four degrees of freedom: 25 is exceeded by chance with a probability of 5e-5.
  EXPECT_LT(fit->chi2, 25);
  EXPECT_NEAR(fit->seen_per_asked(0, 0), 1, 4 * fit->standard_error(0, 0));
}

TEST(StageFit, SaysNothingOfAStageThatWasNotAskedToMove) {
  auto places = seen_where([](cv::Point2d a, int) { return a; });
  for (ShiftSeen& place : places) place.asked_px = {0, 0};

  EXPECT_FALSE(fit_stage(places).has_value());
}

}  // namespace
}  // namespace todbench
