// SPDX-License-Identifier: GPL-3.0-or-later
// Edges with tails: the intervals hold the truth of pictures that another method made.
#include <gmock/gmock.h>

#include <cmath>

#include "tests/tod/measures/tail_coverage.h"
#include "tod/measures/bounded_least_squares.h"
#include "tod/measures/slanted_edge.h"

namespace todbench {
namespace {

using test::TailedEdge;
using test::TailedLens;
using test::TailedProfile;

TEST(BoundedLeastSquares, FindsTheMinimumWithinBoundsAndTheFarthestPoint) {
  // q = (x - 1)^2 + (y + 1)^2 - 2, y >= 0: the minimum is (1, 0) with q of -1.
  const BoundedLeastSquares problem({1, 0, 0, 1}, {1, -1}, {-HUGE_VAL, 0}, {HUGE_VAL, HUGE_VAL});

  EXPECT_NEAR(problem.best()[0], 1, 1e-12);
  EXPECT_EQ(problem.best()[1], 0);
  // Excess of 4: 2 along x; along y (y + 1)^2 = 1 + 4.
  EXPECT_NEAR(problem.farthest({1, 0}, 4)[0], 3, 0.003);
  EXPECT_NEAR(problem.farthest({0, 1}, 4)[1], std::sqrt(5.0) - 1, 0.003);
}

TEST(BoundedLeastSquares, MeetsTheConditionsOfAMinimumWhereColumnsDependOnEachOther) {
  constexpr std::size_t n = 28;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const RandomStream random(seed, "least squares");
    std::uint64_t draw = 0;
    std::vector<double> gram(n * n), right(n);
    for (int row = 0; row < 60; ++row) {
      // Normal bells of nearly equal width: a condition of 1e15 and more.
      std::vector<double> a(n);
      for (std::size_t i = 0; i < n; ++i) a[i] = std::exp(-0.5 * std::pow(row / (5 + 0.3 * static_cast<double>(i)), 2));
      const double y = a[3] + a[20] + 0.01 * random.normal(draw++);
      for (std::size_t i = 0; i < n; ++i) {
        right[i] += 1e4 * a[i] * y;
        for (std::size_t j = 0; j < n; ++j) gram[i * n + j] += 1e4 * a[i] * a[j];
      }
    }

    const BoundedLeastSquares problem(gram, right, std::vector<double>(n, 0.0), std::vector<double>(n, 1.5));

    for (std::size_t i = 0; i < n; ++i) {
      double half_slope = -right[i];
      for (std::size_t j = 0; j < n; ++j) half_slope += gram[i * n + j] * problem.best()[j];
      const double x = problem.best()[i], tolerance = 1e-9 * right[i];
      EXPECT_TRUE(x >= 0 && x <= 1.5);
      EXPECT_TRUE(x == 1.5 || half_slope > -tolerance) << seed << " " << i;
      EXPECT_TRUE(x == 0 || half_slope < tolerance) << seed << " " << i;
    }
  }
}

// Each of 32 lenses twice; 128 intervals at two frequencies where tails act. Intervals hold 0.96 of the truths over 512
// pictures (measures_study); fewer than 112 of 128 would happen once in 10000 studies if pictures were independent.
TEST(SlantedEdge, HoldsTheTruthOfLensesWithTailsAndHalos) {
  const test::TailCoverage found = test::tail_coverage(0, 63);

  EXPECT_EQ(found.edges, 64);
  EXPECT_GE(found.inside[1] + found.inside[2], 112);
  EXPECT_GE(found.inside_any[1] + found.inside_any[2], 112);
  // Pictures that tell halos from shading have both ends.
  EXPECT_LE(found.open[1], 6);
  EXPECT_EQ(found.sharpened, 0);
}

TEST(SlantedEdge, HoldsTheTruthOfHalosBeyondTheDefaultBound) {
  for (const auto& [share, sigma] : {std::pair(0.3, 3.0), std::pair(0.3, 25.0), std::pair(0.4, 10.0)}) {
    const TailedLens lens{.halos = {{share, sigma}}};
    const TailedProfile profile(lens, 5);
    for (const int side : {64, 120, 240}) {
      const TailedEdge made{.rows = side, .columns = side, .noise = 0.0003};
      const SlantedEdge edge = slanted_edge(made.picture(profile, 2), {}).value();
      for (const std::size_t i : {std::size_t{5}, std::size_t{10}, std::size_t{25}}) {
        const double truth = lens.mtf(edge.frequency_per_pitch[i], made.angle_deg);
        EXPECT_LE(edge.mtf_low[i], truth) << share << " " << sigma << " " << side << " " << i;
        EXPECT_GE(edge.mtf_high[i], truth) << share << " " << sigma << " " << side << " " << i;
      }
    }
  }
}

TEST(SlantedEdge, HoldsTheTruthOfSharpenedPictures) {
  for (const auto& [amount, sigma] : {std::pair(0.3, 1.5), std::pair(0.3, 5.0), std::pair(0.03, 10.0)}) {
    for (const double noise : {0.0003, 0.003}) {
      const test::SharpenedCoverage seen = test::sharpened_coverage(amount, sigma, 120, noise, 1);

      EXPECT_EQ(seen.found, 2) << amount << " " << sigma << " " << noise;
      EXPECT_EQ(seen.inside, seen.intervals) << amount << " " << sigma << " " << noise;
      EXPECT_EQ(seen.intervals, 8);
    }
  }
}

TEST(SlantedEdge, ALowEndAllowsForHalosThatThePictureShowsInPart) {
  for (const double share : {0.05, 0.1}) {
    for (const double sigma : {20.0, 31.0, 45.0, 60.0}) {
      const TailedLens lens{.halos = {{share, sigma}}};
      const TailedProfile profile(lens, 5);
      for (std::uint64_t seed = 1; seed <= 2; ++seed) {
        const TailedEdge made{.rows = 120, .columns = 120, .noise = 0.002};
        const SlantedEdge edge = slanted_edge(made.picture(profile, seed), {}).value();
        for (const std::size_t i : {std::size_t{5}, std::size_t{20}}) {
          const double truth = lens.mtf(edge.frequency_per_pitch[i], made.angle_deg);
          EXPECT_LE(edge.mtf_low[i], truth) << share << " " << sigma;
          EXPECT_GE(edge.mtf_high[i], truth) << share << " " << sigma;
        }
      }
    }
  }
}

TEST(SlantedEdge, FindsNoWideHalosInPicturesWithout) {
  const TailedProfile plain(TailedLens{}, 5), narrow(TailedLens{.halos = {{0.05, 8}}}, 5);
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    for (const TailedProfile* profile : {&plain, &narrow}) {
      const TailedEdge made{
          .rows = 120, .columns = 120, .noise = 0.002, .shading_dark = 0.003, .shading_bright = -0.005};
      found += slanted_edge(made.picture(*profile, seed), {}).value().wide_halo_least > 0.002 ? 1 : 0;
    }
  }
  // 2.5 % of 40: more than 5 would happen once in 1000 times.
  EXPECT_LE(found, 5);
}

TEST(SlantedEdge, IsRelativeToASourceOfTheSizeOfThePicture) {
  const TailedLens lens{.halos = {{0.1, 50}}};
  const TailedProfile profile(lens, 5);

  const auto small = slanted_edge(TailedEdge{}.picture(profile, 1), {}).value();
  const auto large = slanted_edge(TailedEdge{.rows = 120, .columns = 220}.picture(profile, 1), {}).value();

  EXPECT_NEAR(small.widest_halo_pitch, 6.5, 0.1);
  EXPECT_TRUE(small.low_known[10]);
  EXPECT_NEAR(small.mtf[10], TailedLens{}.mtf(0.1, 5), 0.03);
  EXPECT_NEAR(large.mtf[10], lens.mtf(0.1, 5), 0.03);
}

TEST(SlantedEdge, StatesNoLowerEndWhereNoiseHidesHalos) {
  const TailedLens lens;
  const TailedEdge made{.noise = 0.08};

  const auto edge = slanted_edge(made.picture(TailedProfile(lens, 5), 1), {}).value();

  EXPECT_FALSE(edge.low_known[10]);
  EXPECT_GE(edge.mtf_high[10], lens.mtf(0.1, 5));
}

TEST(SlantedEdge, AllowsForInterlacedLinesAndRefusesFarOnes) {
  const TailedLens lens;
  const TailedProfile profile(lens, 5);
  const auto interlaced = [&](double apart) {
    cv::Mat1d picture = TailedEdge{.edge_at_pitch = -0.5 * apart, .rows = 120, .columns = 80}.picture(profile, 1);
    const cv::Mat1d other = TailedEdge{.edge_at_pitch = 0.5 * apart, .rows = 120, .columns = 80}.picture(profile, 2);
    for (int y = 1; y < picture.rows; y += 2) other.row(y).copyTo(picture.row(y));
    return picture;
  };

  const auto edge = slanted_edge(interlaced(0.4), {});

  ASSERT_TRUE(edge) << edge.error().message;
  // Measured: cos(pi f 0.4) = 0.81 of the truth at half a cycle.
  EXPECT_LT(edge->mtf[50], 0.9 * lens.mtf(0.5, 5));
  EXPECT_GE(edge->mtf_high[50], lens.mtf(0.5, 5));
  EXPECT_NEAR(edge->displacement_pitch, 0.2, 0.04);
  EXPECT_THAT(edge->notes, ::testing::Contains(::testing::HasSubstr("displaced")));
  EXPECT_FALSE(slanted_edge(interlaced(0.9), {}));
}

}  // namespace
}  // namespace todbench
