// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/three_d_noise.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <map>
#include <opencv2/imgproc.hpp>

#include "tests/tod/measures/measures_reference.h"
#include "tests/tod/measures/simulated_cube.h"
#include "tod/measures/shading.h"

namespace todbench {
namespace {

using enum NoiseComponent;

template <typename Pixel>
NoiseTable table_of(const std::vector<cv::Mat_<Pixel>>& frames) {
  NoiseCube cube;
  for (const auto& frame : frames) EXPECT_TRUE(cube.add(frame));
  return cube.table().value();
}

TEST(NoiseCube, GivesMeanSquaresSignedVariancesAndFTestsOfTheReference) {
  for (const auto& reference : test::reference_cases("noise3d", "cubes")) {
    const NoiseTable table = table_of(test::frames_of<std::uint16_t>(reference));

    // To 1e-9 of the pixels' noise, which is the reference's own tolerance.
    const double tolerance = 1e-9 * reference["unbiased_variance"]["tvh"].get<double>();
    for (const NoiseComponent component : noise_components) {
      const std::string name(to_string(component));
      EXPECT_EQ(table.degrees_of_freedom[component], reference["degrees_of_freedom"][name]) << name;
      // The reference has ten digits of a mean square.
      EXPECT_NEAR(table.mean_squares[component], reference["mean_squares"][name],
                  1e-9 * reference["mean_squares"][name].get<double>());
      EXPECT_NEAR(estimate_of(table, component).variance, reference["unbiased_variance"][name], tolerance) << name;
    }
    for (const NoiseComponent component : {tv, th, vh}) {
      const double p = reference["f_test_p"][std::string(to_string(component))];
      EXPECT_NEAR(estimate_of(table, component).p_absent.value(), p, 1e-8 * p);
    }
    EXPECT_NEAR(estimate_of(table, tvh).low, reference["tvh_variance_ci95"][0], tolerance);
    EXPECT_NEAR(estimate_of(table, tvh).high, reference["tvh_variance_ci95"][1], tolerance);
  }
}

TEST(NoiseCube, GivesTheIntervalsOfTheReference) {
  for (const auto& reference : test::reference_cases("noise3d_intervals", "intervals")) {
    NoiseTable table;
    table.frames = reference["frames"], table.rows = reference["rows"], table.columns = reference["columns"];
    const double n = table.frames - 1, m = table.rows - 1, l = table.columns - 1;
    ByComponent& freedom = table.degrees_of_freedom;
    freedom[t] = n, freedom[v] = m, freedom[h] = l;
    freedom[tv] = n * m, freedom[th] = n * l, freedom[vh] = m * l, freedom[tvh] = n * m * l;
    for (const NoiseComponent component : noise_components)
      table.mean_squares[component] = reference["mean_squares"][std::string(to_string(component))];

    for (const NoiseComponent component : noise_components) {
      const auto& wanted = reference["interval95"][std::string(to_string(component))];
      const ComponentEstimate found = estimate_of(table, component);
      const double tolerance = 1e-8 * wanted[2].get<double>();
      EXPECT_NEAR(found.variance, wanted[0], tolerance) << to_string(component);
      EXPECT_NEAR(found.low, wanted[1], tolerance) << to_string(component);
      EXPECT_NEAR(found.high, wanted[2], tolerance) << to_string(component);
    }
  }
}

TEST(NoiseCube, HasTheSevenComponentsInsideTheirIntervalsInNineteenOfTwentySeeds) {
  ByComponent sd;
  sd[t] = 1, sd[v] = 2, sd[h] = 3, sd[tv] = 4, sd[th] = 0, sd[vh] = 6, sd[tvh] = 20;
  constexpr int seeds = 60;
  std::map<NoiseComponent, int> inside;

  for (int seed = 1; seed <= seeds; ++seed) {
    const NoiseTable table = table_of(test::simulated_cube(12, 10, 14, sd, static_cast<std::uint64_t>(seed)));
    for (const NoiseComponent component : noise_components) {
      const ComponentEstimate found = estimate_of(table, component);
      const double truth = sd[component] * sd[component];
      if (found.low <= truth && truth <= found.high) ++inside[component];
    }
  }

  // 95 % less four standard errors of a proportion from 60 seeds: 0.95 - 4 * 0.028.
  for (const NoiseComponent component : noise_components)
    EXPECT_GE(inside[component], 0.837 * seeds) << to_string(component);
}

TEST(NoiseCube, TakesNoNoiseThatRemembersForAFixedPattern) {
  constexpr int frames = 40, rows = 24, columns = 30;
  for (const double rho : {0.4, 0.8, -0.3}) {
    for (const double pattern : {0.0, 0.5}) {
      double fixed = 0, pixels = 0, plain = 0;
      int fixed_inside = 0, pixels_inside = 0, whole_inside = 0;
      constexpr int seeds = 20;
      for (int seed = 1; seed <= seeds; ++seed) {
        ByComponent sd;
        sd[tvh] = 1;
        const auto fresh = test::simulated_cube(frames, rows, columns, sd, static_cast<std::uint64_t>(seed));
        sd[tvh] = 0, sd[vh] = pattern;
        const auto still = test::simulated_cube(2, rows, columns, sd, static_cast<std::uint64_t>(seed));
        NoiseCube cube;
        cv::Mat1d state = fresh[0] - 8000;  // the level of the cubes
        for (std::size_t k = 0; k < fresh.size(); ++k) {
          if (k > 0) state = rho * state + std::sqrt(1 - rho * rho) * (fresh[k] - 8000);
          ASSERT_TRUE(cube.add(cv::Mat1d(state + still[0])));
        }
        // 27000 values, and the variance of a correlation falls as 1 - rho^2.
        EXPECT_NEAR(cube.lag1_correlation().value(), rho, 4 * std::sqrt((1 - rho * rho) / (frames * rows * columns)));
        NoiseTable table = cube.table().value();
        plain += estimate_of(table, vh).variance / seeds;
        table.pixel_memory = cube.pixel_memory();
        const ComponentEstimate of_fixed = estimate_of(table, vh), of_pixels = estimate_of(table, tvh),
                                whole = temporal_variance(table);
        fixed += of_fixed.variance / seeds, pixels += of_pixels.variance / seeds;
        const double truth = pattern * pattern;
        if (of_fixed.low <= truth && truth <= of_fixed.high) ++fixed_inside;
        if (of_pixels.low <= 1 && 1 <= of_pixels.high) ++pixels_inside;
        if (whole.low <= 1 && 1 <= whole.high) ++whole_inside;
      }
      // Four standard errors of a mean square over 667 pixels and 20 seeds, of (1 + rho) / (1 - rho) / 40 and the
      // pattern.
      const double left = (1 + rho) / (1 - rho) / frames, scatter = std::sqrt(2.0 / (23 * 29) / seeds);
      EXPECT_NEAR(fixed, pattern * pattern, 4 * scatter * (left + pattern * pattern)) << rho;
      EXPECT_NEAR(pixels, 1, 0.015) << rho;
      EXPECT_GT(std::abs(plain - pattern * pattern), std::abs(left - 1.0 / frames) / 2) << rho;
      // 95 % less four standard errors of a proportion from 20 seeds.
      EXPECT_GE(fixed_inside, 15) << rho << ' ' << pattern;
      EXPECT_GE(pixels_inside, 15) << rho;
      EXPECT_GE(whole_inside, 15) << rho;
    }
  }
}

TEST(NoiseCube, HasNoMemoryWhereItIsChanceOrDrift) {
  ByComponent sd;
  sd[tvh] = 1;
  const auto frames = test::simulated_cube(40, 24, 30, sd, 1);
  NoiseCube white, drifting;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    ASSERT_TRUE(white.add(frames[k]));
    ASSERT_TRUE(drifting.add(cv::Mat1d(frames[k] + 10.0 * static_cast<double>(k) * frames[0])));
  }

  EXPECT_EQ(white.pixel_memory(), 0);
  EXPECT_EQ(drifting.pixel_memory(), 0);
  EXPECT_GT(drifting.lag1_correlation().value(), 0.95);
}

TEST(NoiseCube, LosesNothingUnderASceneOfManyTimesTheNoiseAndJumpsOfWholeFrames) {
  const std::vector<cv::Mat1d> quiet = test::simulated_cube(
      6, 8, 9,
      [] {
        ByComponent sd;
        sd[tvh] = 0.02, sd[tv] = 0.01, sd[th] = 0.01;
        return sd;
      }(),
      1);
  std::vector<cv::Mat1d> loud;
  for (std::size_t k = 0; k < quiet.size(); ++k) {
    cv::Mat1d frame = quiet[k].clone();
    for (int y = 0; y < frame.rows; ++y) {
      for (int x = 0; x < frame.cols; ++x) frame(y, x) += 5000.0 * ((x * y) % 3) + 300.0 * static_cast<double>(k % 2);
    }
    loud.push_back(frame);
  }

  const NoiseTable without = table_of(quiet), with = table_of(loud);

  // The scene costs the last digits of a count of 20000: 4e-12 of each value, against noise of 0.02.
  for (const NoiseComponent component : {tv, th, tvh})
    EXPECT_NEAR(with.mean_squares[component], without.mean_squares[component], 1e-8 * without.mean_squares[component]);
}

TEST(NoiseCube, SeesThatThePatternChangedAndTakesNoNoiseForIt) {
  ByComponent sd;
  sd[t] = 30, sd[v] = 5, sd[tv] = 10, sd[th] = 10, sd[vh] = 20, sd[tvh] = 10;
  ByComponent other;
  other[vh] = 15;
  for (int seed = 1; seed <= 20; ++seed) {
    const auto random = static_cast<std::uint64_t>(seed);
    const std::vector<cv::Mat1d> cube = test::simulated_cube(16, 24, 32, sd, random);
    const cv::Mat1d pattern = test::simulated_cube(1, 24, 32, other, random + 1000)[0];
    NoiseCube still, corrected;

    for (int k = 0; k < 16; ++k) {
      ASSERT_TRUE(still.add(cube[static_cast<std::size_t>(k)]));
      ASSERT_TRUE(corrected.add(k < 9 ? cube[static_cast<std::size_t>(k)]
                                      : cv::Mat1d(cube[static_cast<std::size_t>(k)] + pattern)));
    }

    // A pattern of 1.5 standard deviations makes the difference of two frames 1 + 1.5^2 / 2 times its mean square.
    EXPECT_EQ(still.abrupt_change(), std::nullopt) << seed;
    EXPECT_FALSE(still.noise_changes()) << seed;
    EXPECT_EQ(corrected.abrupt_change(), 9) << seed;
    EXPECT_TRUE(corrected.few_pairs_stand_out()) << seed;
  }
}

TEST(NoiseCube, HasTheMeanVarianceOfThePixelsAsWhatChangesInTime) {
  for (const auto& reference : test::reference_cases("sitf_netd", "netd")) {
    const NoiseTable table = table_of(test::frames_of<double>(reference));

    const ComponentEstimate found = temporal_variance(table);

    const double sd = reference["temporal_sd_rms"];
    EXPECT_NEAR(found.variance, sd * sd, 1e-9 * sd * sd);
    EXPECT_LT(found.low, found.variance);
    EXPECT_GT(found.high, found.variance);
  }
}

TEST(NoiseCube, LeavesAShadingOutOfTheFixedComponentsOnly) {
  ByComponent sd;
  sd[vh] = 3, sd[tvh] = 5;
  const std::vector<cv::Mat1d> flat = test::simulated_cube(8, 30, 40, sd, 1);
  NoiseCube plain, shaded;
  cv::Mat1d bowl(30, 40);
  for (int y = 0; y < bowl.rows; ++y) {
    for (int x = 0; x < bowl.cols; ++x) bowl(y, x) = 0.1 * (x - 12) * (x - 12) + 2 * y - 0.05 * x * y;
  }

  for (const auto& frame : flat) {
    ASSERT_TRUE(plain.add(frame));
    ASSERT_TRUE(shaded.add(cv::Mat1d(frame + bowl)));
  }
  const auto with = shaded.table_without(shading_of(shaded.mean_frame()).surface).value();
  const auto without = plain.table_without(shading_of(plain.mean_frame()).surface).value();

  // A surface of second order is taken out to the last digits, whatever stands on it.
  for (const NoiseComponent component : noise_components)
    EXPECT_NEAR(with.mean_squares[component], without.mean_squares[component], 1e-8 * without.mean_squares[component]);
  // The surface found is the one put in, not the pattern.
  EXPECT_GT(shading_of(shaded.mean_frame()).range, 60);
  EXPECT_LT(shading_of(plain.mean_frame()).range, 4);
}

TEST(NoiseCube, RefusesWhatIsNoTable) {
  NoiseCube cube;
  EXPECT_FALSE(cube.table());
  EXPECT_FALSE(cube.add(cv::Mat1d()));
  ASSERT_TRUE(cube.add(cv::Mat1d(3, 4, 1.0)));
  EXPECT_FALSE(cube.table());
  EXPECT_FALSE(cube.add(cv::Mat1d(4, 3, 1.0)));
  EXPECT_FALSE(cube.add(cv::Mat1d(3, 4, std::numeric_limits<double>::quiet_NaN())));
  ASSERT_TRUE(cube.add(cv::Mat1d(3, 4, 2.0)));
  EXPECT_TRUE(cube.table());
}

NoiseCube cube_of(const std::vector<cv::Mat1d>& frames) {
  NoiseCube cube;
  for (const cv::Mat1d& frame : frames) EXPECT_TRUE(cube.add(frame));
  return cube;
}

TEST(NoiseCube, FindsARowOfTelemetry) {
  ByComponent sd;
  sd[tvh] = 5, sd[vh] = 10;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    for (const int row : {0, 2, 29, 31}) {
      const RandomStream words(seed, "telemetry");
      std::vector<cv::Mat1d> changing = test::simulated_cube(8, 32, 40, sd, seed), constant;
      for (const cv::Mat1d& frame : changing) constant.push_back(frame.clone());
      for (std::size_t k = 0; k < changing.size(); ++k) {
        for (int x = 0; x < 40; ++x) {
          const auto at = static_cast<std::uint64_t>(x);
          changing[k](row, x) = 65535 * words.sub(k).uniform(at);
          // A frame counter among words that stay.
          constant[k](row, x) = x == 3 ? static_cast<double>(k) : 65535 * words.uniform(at);
        }
      }
      EXPECT_EQ(cube_of(changing).row_outside_picture(), row) << seed;
      EXPECT_EQ(cube_of(constant).row_outside_picture(), row) << seed;
    }
  }
}

TEST(NoiseCube, TakesNoRowOfThePictureForTelemetry) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    ByComponent sd;
    sd[tvh] = 1, sd[vh] = seed % 3 == 0 ? 0 : 10, sd[v] = seed % 2 == 0 ? 30 : 0, sd[tv] = seed % 5 == 0 ? 20 : 0;
    std::vector<cv::Mat1d> frames = test::simulated_cube(2 + static_cast<int>(seed % 6), 24, 40, sd, seed);
    // A hot object that ends three rows above the lower edge, behind a lens.
    for (cv::Mat1d& frame : frames) {
      cv::Mat1d object = cv::Mat1d::zeros(frame.size());
      object(cv::Rect(10, 12, 8, 9)) = 500;
      cv::GaussianBlur(object, object, {5, 5}, 0.6);
      frame += object;
    }
    EXPECT_FALSE(cube_of(frames).row_outside_picture()) << seed;
  }
}

}  // namespace
}  // namespace todbench
