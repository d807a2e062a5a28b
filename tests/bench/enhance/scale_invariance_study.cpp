// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a gain of the stages moves the acuity, over seeds, gains, sizes of a count and observers.
// TODBENCH_STUDY_RUNS: seeds of each case (40 without it).
#include <cstdio>
#include <cstdlib>

#include "bench/plan/descriptions.h"
#include "bench/plan/resources.h"
#include "tests/bench/enhance/scale_invariance.h"

namespace todbench {
namespace {

using namespace testing_support;

int runs() {
  const char* asked = std::getenv("TODBENCH_STUDY_RUNS");
  return asked == nullptr ? 40 : std::atoi(asked);
}

/// Of one gain over the seeds.
struct Sums {
  double answers = 0, ln_ratio = 0, squares = 0, half_width = 0;
  int intervals = 0, holding = 0;

  void add(const Moved& moved) {
    answers += moved.answers;
    ln_ratio += moved.ln_ratio;
    squares += moved.ln_ratio * moved.ln_ratio;
    if (!moved.half_width) return;
    ++intervals;
    half_width += *moved.half_width;
    holding += std::abs(moved.ln_ratio) <= *moved.half_width ? 1 : 0;
  }
};

void report(const std::string& observer, double kelvin_per_count, double gain, const Sums& sums) {
  const double n = runs(), mean = sums.ln_ratio / n;
  const double sd = std::sqrt(std::max(0.0, sums.squares / n - mean * mean));
  std::printf(
      "%-14s %2g mK a count, gain %.1f: %.2f %% of answers differ, ln ratio %+.4f +- %.4f, half-width %.4f, "
      "%d of %d intervals hold 0\n",
      observer.c_str(), 1e3 * kelvin_per_count, gain, 100 * sums.answers / n, mean, sd / std::sqrt(n),
      sums.half_width / std::max(1, sums.intervals), sums.holding, sums.intervals);
  std::fflush(stdout);
  // Rounding adds to the noise at most what a gain of 0.1 leaves of it: 17 % of the sensor's variance. No ratio may
  // move by more than its own scatter explains.
  EXPECT_LT(std::abs(mean), 0.005 + 4 * sd / std::sqrt(n)) << observer << " " << gain;
}

TEST(ScaleInvarianceStudy, AGainMovesNoAcuity) {
  const std::vector<double> gains = {0.1, 0.3, 3};
  std::vector<EnhancementPackage> packages;
  for (const double gain : gains) packages.push_back(gain_of(gain));
  for (const std::string& observer : resource_names(ResourceKind::observer)) {
    if (!load_observer(observer)) continue;  // one with an eye judges displays only
    for (const double kelvin_per_count : {0.01, 0.001}) {
      std::vector<Sums> sums(gains.size());
      for (int run = 1; run <= runs(); ++run) {
        const auto plan = plan_of_counts(observer, 4, static_cast<std::uint64_t>(run), kelvin_per_count);
        const auto found = compare_packages(plan, packages, {}, {});
        ASSERT_TRUE(found) << found.error().message;
        for (std::size_t i = 0; i < gains.size(); ++i) {
          ASSERT_FALSE(found->results[i + 1].error) << found->results[i + 1].error->message;
          sums[i].add(moved_by(found->results[i + 1], found->results[0]));
        }
      }
      for (std::size_t i = 0; i < gains.size(); ++i) report(observer, kelvin_per_count, gains[i], sums[i]);
    }
  }
}

}  // namespace
}  // namespace todbench
