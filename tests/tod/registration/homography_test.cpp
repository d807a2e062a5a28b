// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/registration/homography.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "acquisition/base/rng.h"
#include "tests/tod/registration/plate_picture.h"

namespace todbench {
namespace {

using testing::mapped;

const cv::Matx33d tilted(0.38, 0.01, 80, -0.01, 0.38, 70, 2e-4, -1e-4, 1);

std::vector<cv::Point2d> grid(int columns, int rows) {
  std::vector<cv::Point2d> out;
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) out.emplace_back(60.0 * x - 120 + 7 * y, 45.0 * y - 90);
  return out;
}

double sum_of_squares(const cv::Matx33d& h, const std::vector<cv::Point2d>& from, const std::vector<cv::Point2d>& to) {
  double sum = 0;
  for (std::size_t i = 0; i < from.size(); ++i) sum += std::pow(cv::norm(to[i] - mapped(h, from[i])), 2);
  return sum;
}

TEST(Homography, IsFoundFromExactPlaces) {
  for (const auto& from : {grid(2, 2), grid(5, 4)}) {
    std::vector<cv::Point2d> to;
    for (const cv::Point2d& p : from) to.push_back(mapped(tilted, p));
    const auto found = fit_homography(from, to);
    ASSERT_TRUE(found.has_value());
    EXPECT_EQ((*found)(2, 2), 1);
    for (const cv::Point2d& p : grid(7, 6)) EXPECT_LT(cv::norm(mapped(*found, p) - mapped(tilted, p)), 1e-9);
  }
}

/// No step in any element makes the sum of squares smaller: steps of its own rounding apart.
TEST(Homography, LeavesTheLeastSumOfSquares) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const RandomStream noise(seed, "homography");
    const auto from = grid(5, 4);
    std::vector<cv::Point2d> to;
    for (std::uint64_t i = 0; i < from.size(); ++i)
      to.push_back(mapped(tilted, from[i]) + cv::Point2d(noise.normal(2 * i), noise.normal(2 * i + 1)));
    const auto found = fit_homography(from, to);
    ASSERT_TRUE(found.has_value());
    const double least = sum_of_squares(*found, from, to);
    EXPECT_LT(least, sum_of_squares(tilted, from, to));
    for (int element = 0; element < 8; ++element) {
      const std::array<double, 3> size{0.38, 80, 2e-4};
      const double step = 1e-5 * size[element % 3 == 2 ? 1 : element >= 6 ? 2 : 0];
      for (const double sign : {1.0, -1.0}) {
        cv::Matx33d other = *found;
        other.val[element] += sign * step;
        EXPECT_GE(sum_of_squares(other, from, to), least) << "seed " << seed << ", element " << element;
      }
    }
  }
}

TEST(Homography, IsRefusedWherePlacesFixNone) {
  std::vector<cv::Point2d> line, to;
  for (int i = 0; i < 8; ++i) {
    line.emplace_back(10.0 * i, 5.0 * i);
    to.push_back(mapped(tilted, line.back()));
  }
  EXPECT_FALSE(fit_homography(line, to).has_value());
  const auto three = grid(3, 1);
  EXPECT_FALSE(fit_homography(three, three).has_value());
}

}  // namespace
}  // namespace todbench
