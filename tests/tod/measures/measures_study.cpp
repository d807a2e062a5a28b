// SPDX-License-Identifier: GPL-3.0-or-later
// Coverage of the intervals of single measures over 200 seeds.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "tests/tod/measures/edge_picture.h"
#include "tests/tod/measures/simulated_cube.h"
#include "tests/tod/measures/tail_coverage.h"
#include "tod/measures/slanted_edge.h"

namespace todbench {
namespace {

using enum NoiseComponent;

constexpr int seeds = 200;
// 95 % less four standard errors of a proportion from 200 seeds.
constexpr double least_coverage = 0.888;

struct Design {
  int frames, rows, columns;
  double sd[noise_components.size()];  // in the order of the components
};

TEST(MeasuresStudy, IntervalsOfTheSevenComponentsHoldTheTruth) {
  for (const Design& design : {Design{16, 24, 32, {1, 2, 3, 4, 5, 6, 20}}, Design{32, 16, 20, {10, 0, 0, 3, 3, 0, 10}},
                               Design{8, 40, 40, {0, 5, 5, 0, 0, 20, 10}}}) {
    ByComponent sd;
    for (const NoiseComponent component : noise_components)
      sd[component] = design.sd[static_cast<std::size_t>(component)];
    std::map<NoiseComponent, int> inside;

    for (int seed = 1; seed <= seeds; ++seed) {
      NoiseCube cube;
      for (const auto& frame :
           test::simulated_cube(design.frames, design.rows, design.columns, sd, static_cast<std::uint64_t>(seed)))
        ASSERT_TRUE(cube.add(frame));
      EXPECT_FALSE(cube.abrupt_change());
      const NoiseTable table = cube.table().value();
      for (const NoiseComponent component : noise_components) {
        const ComponentEstimate found = estimate_of(table, component);
        const double truth = sd[component] * sd[component];
        if (found.low <= truth && truth <= found.high) ++inside[component];
      }
    }

    std::printf("%d x %d x %d:", design.frames, design.rows, design.columns);
    for (const NoiseComponent component : noise_components) {
      std::printf(" %s %.3f", std::string(to_string(component)).c_str(),
                  inside[component] / static_cast<double>(seeds));
      EXPECT_GE(inside[component], least_coverage * seeds) << to_string(component);
    }
    std::printf("\n");
  }
}

TEST(MeasuresStudy, IntervalsOfTheEdgeHoldTheTruth) {
  for (const double blur : {0.3, 0.7}) {
    for (const double noise : {0.002, 0.02, 0.05}) {
      const test::EdgePicture made{.blur_sigma_pitch = blur};
      std::map<int, int> inside;

      for (int seed = 1; seed <= seeds; ++seed) {
        const auto edge = slanted_edge(made.noisy(noise, static_cast<std::uint64_t>(seed)), {}).value();
        for (const int k : {5, 10, 20, 30, 50}) {
          const auto i = static_cast<std::size_t>(k);
          const double truth = made.mtf(k / 100.0);
          if (edge.mtf_low_in_picture[i] <= truth && truth <= edge.mtf_high[i]) ++inside[k];
        }
      }

      std::printf("blur %.1f, noise %.3f:", blur, noise);
      for (const auto& [k, count] : inside) {
        std::printf(" f %.2f %.3f", k / 100.0, count / static_cast<double>(seeds));
        EXPECT_GE(count, least_coverage * seeds) << k;
      }
      std::printf("\n");
    }
  }
}

// TODBENCH_STUDY_RUNS: pictures (512 without it).
TEST(MeasuresStudy, IntervalsOfEdgesWithTailsHoldTheTruth) {
  const char* asked = std::getenv("TODBENCH_STUDY_RUNS");
  const std::uint64_t pictures = asked != nullptr ? std::strtoull(asked, nullptr, 10) : test::tailed_pictures;

  const test::TailCoverage found = test::tail_coverage(0, pictures - 1);

  std::printf("%d pictures, %d refused\n", found.edges, found.refused);
  std::printf("%d said to be sharpened\n", found.sharpened);
  EXPECT_EQ(found.refused, 0);
  EXPECT_LE(found.sharpened, 0.01 * found.edges);
  for (std::size_t k = 0; k < test::TailCoverage::frequencies.size(); ++k) {
    const auto mean = [&](const test::TailCoverage::Each& sum) { return sum[k] / found.edges; };
    std::printf("f %.2f: within %.3f (of any source %.3f), error %+.4f, interval -%.4f +%.4f, without a low end %.3f\n",
                test::TailCoverage::frequencies[k], mean(found.inside), mean(found.inside_any), mean(found.error),
                mean(found.below), mean(found.above), mean(found.open));
    const double least = 0.95 - 4 * std::sqrt(0.05 * 0.95 / found.edges);
    EXPECT_GE(mean(found.inside), least) << k;
    EXPECT_GE(mean(found.inside_any), least) << k;
  }
}

TEST(MeasuresStudy, IntervalsOfSharpenedPicturesHoldTheTruth) {
  constexpr std::uint64_t each = 10;
  for (const auto& [amount, sigma] :
       {std::pair(0.3, 1.5), std::pair(0.3, 5.0), std::pair(0.1, 5.0), std::pair(0.1, 12.0), std::pair(0.03, 10.0)}) {
    for (const int side : {64, 120, 200}) {
      for (const double noise : {0.0003, 0.003, 0.01}) {
        const test::SharpenedCoverage seen = test::sharpened_coverage(amount, sigma, side, noise, each);
        std::printf("amount %.2f, sigma %4.1f, %3d pixels, noise %.4f: %d of %d found, %d of %d intervals\n", amount,
                    sigma, side, noise, seen.found, seen.edges, seen.inside, seen.intervals);
        EXPECT_GE(seen.inside, least_coverage * seen.intervals);
      }
    }
  }
}

}  // namespace
}  // namespace todbench
