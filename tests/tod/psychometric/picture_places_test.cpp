// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/psychometric/picture_places.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace todbench {
namespace {

using ::testing::ElementsAre;

Trial seen(const std::string& plate, Mounting mounting, const std::string& triangle, double x_px, double y_px,
           double size_px) {
  Trial trial;
  trial.plate = plate;
  trial.mounting = mounting;
  trial.triangle = triangle;
  trial.size_px = size_px;
  trial.centroid = PlaceInPicture{x_px, y_px};
  return trial;
}

constexpr Mounting as_drawn = Mounting::identity, turned = Mounting::rotated_180;

TEST(PicturePlaces, AreOneWhereSetUpsPutTrianglesBeforeTheSameDetectors) {
  const std::vector<Trial> trials{seen("a", as_drawn, "1", 100, 50, 4), seen("a", as_drawn, "2", 120, 50, 4),
                                  seen("a", turned, "2", 101, 52, 4), seen("b", as_drawn, "1", 100, 54, 2),
                                  seen("b", as_drawn, "2", 120, 46.6, 2)};

  EXPECT_THAT(picture_places(trials), ElementsAre(0, 1, 0, 2, 1));
}

TEST(PicturePlaces, OfATriangleIsTheMeanOverItsPresentations) {
  // Apart by 3.6 pixels in the first presentation, by 2.8 in the mean: half of 3 and 1.5 are 3.
  const std::vector<Trial> trials{seen("a", as_drawn, "1", 100, 50, 3), seen("a", turned, "1", 103.6, 50, 3),
                                  seen("a", as_drawn, "1", 100.8, 50, 3), seen("a", turned, "1", 102.8, 50, 3)};

  EXPECT_THAT(picture_places(trials), ElementsAre(0, 0, 0, 0));
}

TEST(PicturePlaces, DoNotGrowIntoEachOther) {
  // Each is near its neighbour; the third is not near the first one, which has the place.
  const std::vector<Trial> trials{seen("a", as_drawn, "1", 100, 50, 2), seen("b", as_drawn, "1", 102, 50, 2),
                                  seen("c", as_drawn, "1", 104, 50, 2)};

  EXPECT_THAT(picture_places(trials), ElementsAre(0, 0, 1));
}

TEST(PicturePlaces, AreThoseOfTheSetUpWhereATrialDoesNotSayWhereItWas) {
  std::vector<Trial> trials{seen("a", as_drawn, "1", 100, 50, 4), seen("a", turned, "1", 100, 50, 4),
                            seen("a", as_drawn, "1", 100, 50, 4)};
  ASSERT_THAT(picture_places(trials), ElementsAre(0, 0, 0));
  trials[2].centroid.reset();

  EXPECT_THAT(picture_places(trials), ElementsAre(0, 1, 0));
}

}  // namespace
}  // namespace todbench
