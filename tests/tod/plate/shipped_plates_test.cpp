// SPDX-License-Identifier: GPL-3.0-or-later
// The plates that come with the program: what they promise in their comments.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "tests/tod/registration/plate_picture.h"

namespace todbench {
namespace {

using todbench::testing::mm_per_pixel;
using todbench::testing::shipped_plate;

const char* const names[] = {"tcat-a", "tcat-b", "tcat-c", "tcat-d"};

/// Rows of four triangles. The plates with reference triangles have two more.
std::size_t rows_of(const TargetPlate& plate) {
  return plate.triangles.size() / 4;
}

TEST(ShippedPlates, AreValidAndNamedLikeTheirFiles) {
  for (const char* name : names) {
    const TargetPlate plate = shipped_plate(name);

    const auto result = validate(plate);

    EXPECT_TRUE(result.has_value()) << result.error().message;
    EXPECT_EQ(plate.name, name);
    const bool with_references = plate.width_mm > 200;
    EXPECT_EQ(rows_of(plate), with_references ? 7 : 5);
    EXPECT_EQ(plate.width_mm, with_references ? 260 : 200);
    EXPECT_EQ(plate.height_mm, with_references ? 400 : 280);
  }
}

TEST(ShippedPlates, TogetherHaveTenSizesInEqualStepsTakenInTurns) {
  std::map<double, std::string> owner;
  for (const char* name : {"tcat-a", "tcat-b"}) {
    for (const PlateTriangle& t : shipped_plate(name).triangles) owner[t.size_mm] = name;
  }

  ASSERT_EQ(owner.size(), 10U);
  for (auto next = std::next(owner.begin()), it = owner.begin(); next != owner.end(); ++it, ++next) {
    // Sizes are rounded to 0.01 mm: 0.3 % of the smallest.
    EXPECT_NEAR(next->first / it->first, 1.205, 0.005);
    EXPECT_NE(next->second, it->second);
  }
  EXPECT_NEAR(owner.begin()->first / mm_per_pixel, 0.96, 0.01);
  EXPECT_NEAR(owner.rbegin()->first / mm_per_pixel, 5.16, 0.01);
}

TEST(ShippedPlates, ShowEveryOrientationEquallyOftenAlsoPerSizeOverTheMountings) {
  for (const char* name : names) {
    std::map<Apex, int> on_plate;
    std::map<std::pair<double, Apex>, int> over_mountings;
    for (const PlateTriangle& t : shipped_plate(name).triangles) {
      ++on_plate[t.apex];
      for (const Mounting mounting : all_mountings) ++over_mountings[{t.size_mm, mounted(t.apex, mounting)}];
    }

    const std::size_t rows = rows_of(shipped_plate(name));
    for (const Apex apex : all_apexes) EXPECT_EQ(on_plate[apex], static_cast<int>(rows)) << name;
    EXPECT_EQ(over_mountings.size(), rows > 5 ? 24U : 20U);
    for (const auto& [key, count] : over_mountings)
      EXPECT_EQ(count, key.first > 14 ? 8 : 4) << name << " size " << key.first;
  }
}

TEST(ShippedPlates, NoTwoRowsShowTheSamePattern) {
  std::set<std::string> patterns;
  for (const char* name : names) {
    const TargetPlate plate = shipped_plate(name);
    for (std::size_t row = 0; row < rows_of(plate); ++row) {
      std::string pattern;
      for (std::size_t i = 0; i < 4; ++i) pattern += to_string(plate.triangles[4 * row + i].apex).front();
      patterns.insert(pattern);
    }
  }

  // Those of C and D are those of A and B and four more.
  EXPECT_EQ(patterns.size(), 14U);
}

TEST(ShippedPlates, LargeTrianglesLookDifferentInEveryOtherMounting) {
  for (const char* name : names) {
    const TargetPlate plate = shipped_plate(name);
    for (const Mounting mounting : all_mountings) {
      if (mounting == Mounting::identity) continue;
      for (const PlateTriangle& seen : mounted(plate, mounting).triangles) {
        if (seen.size_mm < 7) continue;
        // The triangle that stands where this one is seen, when the plate is not turned.
        const auto nearest = std::ranges::min_element(
            plate.triangles, {}, [&](const PlateTriangle& t) { return cv::norm(t.position_mm - seen.position_mm); });
        EXPECT_NE(nearest->apex, seen.apex) << name << " " << to_string(mounting) << " " << seen.name;
      }
    }
  }
}

TEST(ShippedPlates, WindowOfTheObserverNeverMeetsANeighbourAndStaysOnThePlate) {
  for (const char* name : names) {
    const TargetPlate plate = shipped_plate(name);
    for (const PlateTriangle& t : plate.triangles) {
      // Half of the observer's window, one pixel of search, one pixel of stage shift.
      const double half_px = std::ceil(1.05 * t.size_mm / mm_per_pixel + 2) + 1 + 1;
      const double half = half_px * mm_per_pixel;
      EXPECT_LE(std::abs(t.position_mm.x) + half, plate.width_mm / 2) << name << " " << t.name;
      EXPECT_LE(std::abs(t.position_mm.y) + half, plate.height_mm / 2) << name << " " << t.name;
      for (const PlateTriangle& other : plate.triangles) {
        if (other.name == t.name) continue;
        for (const Mounting mounting : all_mountings) {
          // The bounding box of the neighbour with 1.5 px of blur against the square window.
          double gap = -1e9;
          double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
          for (const cv::Point2d& p : triangle(other.size_mm, mounted(other.apex, mounting), other.position_mm)) {
            left = std::min(left, p.x);
            right = std::max(right, p.x);
            top = std::min(top, p.y);
            bottom = std::max(bottom, p.y);
          }
          gap = std::max({left - t.position_mm.x, t.position_mm.x - right, top - t.position_mm.y,
                          t.position_mm.y - bottom}) -
                half - 1.5 * mm_per_pixel;
          EXPECT_GT(gap, 0) << name << " " << t.name << " and " << other.name;
        }
      }
    }
  }
}

TEST(ShippedPlates, PlacesInARowSpreadOverThePixel) {
  for (const char* name : names) {
    const TargetPlate plate = shipped_plate(name);
    for (std::size_t row = 0; row < rows_of(plate); ++row) {
      std::vector<double> phases;
      for (std::size_t i = 0; i < 4; ++i) {
        const double px = plate.triangles[4 * row + i].position_mm.x / mm_per_pixel;
        phases.push_back(px - std::floor(px));
      }
      std::ranges::sort(phases);
      for (std::size_t i = 0; i < 4; ++i) {
        const double gap = i < 3 ? phases[i + 1] - phases[i] : 1 + phases[0] - phases[3];
        // A quarter of a pixel, with places rounded to 0.1 mm: 0.04 px at either end.
        EXPECT_NEAR(gap, 0.25, 0.08) << name << " row " << row + 1;
      }
    }
  }
}

TEST(ShippedPlates, WithReferencesHaveTheRowsOfTheOthersBetweenThem) {
  for (const auto& [name, of] : {std::pair{"tcat-c", "tcat-a"}, std::pair{"tcat-d", "tcat-b"}}) {
    const TargetPlate plate = shipped_plate(name), inner = shipped_plate(of);
    for (std::size_t i = 0; i < inner.triangles.size(); ++i) {
      const PlateTriangle &t = plate.triangles[4 + i], &same = inner.triangles[i];
      EXPECT_EQ(t.position_mm, same.position_mm);
      EXPECT_EQ(t.size_mm, same.size_mm);
      EXPECT_EQ(t.apex, same.apex);
    }
    for (const std::size_t i : {0U, 3U, 24U, 27U}) EXPECT_EQ(plate.triangles[i].size_mm, 19);
  }
}

}  // namespace
}  // namespace todbench
