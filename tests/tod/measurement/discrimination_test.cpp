// SPDX-License-Identifier: GPL-3.0-or-later
// What a TOD measurement can tell apart: a twin, twice the noise, a tenth more blur.
#include <gmock/gmock.h>

#include <thread>

#include "tests/tod/measurement/measurement_bench.h"
#include "tod/comparison/comparison.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {
namespace {

/// A curve of a camera at one contrast with enough trials for a standard error below a per cent.
TodCurve curve_of(const SensorSpec& spec, std::uint64_t seed, double contrast, int phases) {
  test::SimulatedBench bench;
  bench.spec = spec;
  bench.seed = seed;
  bench.contrasts = {contrast};
  bench.phases = phases;
  TemplateObserver observer({}, triangle_alternatives());
  const auto model = std::make_shared<const SensorModel>(spec, full_plan(spec, {}, {}), Accuracy::draft(), seed);
  const auto result = test::run(bench, observer, test::options_of(bench), model);
  EXPECT_TRUE(result.has_value()) << (result ? "" : result.error().message);
  if (!result) return {};
  auto curve = tod_curve(result->trials, {});
  EXPECT_TRUE(curve.has_value());
  return curve ? *curve : TodCurve{};
}

/// A camera (A) against the SC2000 (B).
ComparisonPoint against_sc2000(const SensorSpec& spec, double contrast, int phases) {
  TodCurve a, b;
  {
    const std::jthread one([&] { a = curve_of(spec, 2, contrast, phases); });
    const std::jthread two([&] { b = curve_of(test::sc2000(), 1, contrast, phases); });
  }
  auto comparison = compare(a, b, {.margin_percent = 10, .fit = {}});
  EXPECT_TRUE(comparison.has_value());
  if (!comparison || comparison->points.empty()) return {};
  const ComparisonPoint point = comparison->points.front();
  std::printf("ratio of acuities %.4f [%.4f, %.4f], p difference %.2g, p equivalence %.2g\n", *point.ratio,
              *point.ratio_ci95.low, *point.ratio_ci95.high, *point.p_difference, *point.p_equivalence);
  return point;
}

TEST(Discrimination, ATwinIsEquivalent) {
  for (const double contrast : {16.9, 0.23}) {
    const ComparisonPoint point = against_sc2000(test::sc2000(), contrast, 40);

    EXPECT_EQ(point.verdict, ComparisonVerdict::equivalent);
    EXPECT_GT(point.p_difference.value_or(0), 0.01);
  }
}

TEST(Discrimination, TwiceTheNoiseIsDifferent) {
  SensorSpec noisy = test::sc2000();
  noisy.netd_k *= 2;

  const ComparisonPoint point = against_sc2000(noisy, 0.23, 40);

  EXPECT_EQ(point.verdict, ComparisonVerdict::different);
  EXPECT_LT(point.ratio_ci95.high.value_or(1), 0.85);
}

TEST(Discrimination, ATenthMoreBlurIsSeenAtLowContrast) {
  // Optics and detectors a tenth wider: the whole point spread scales by 1.1. The camera is undersampled, so that
  // acuity at high contrast hardly changes (0.2 %); at 0.23 K the direct estimate says 2.3 %, four standard errors of
  // this comparison. It stays within a margin of 10 %: equivalent in the sense of the margin, and yet told apart.
  SensorSpec blurred = test::sc2000();
  blurred.f_number *= 1.1;
  blurred.detector_um *= 1.1;

  const ComparisonPoint point = against_sc2000(blurred, 0.23, 640);

  EXPECT_LT(point.p_difference.value_or(1), 0.01);
  EXPECT_LT(point.ratio_ci95.high.value_or(1), 1);
  EXPECT_NEAR(point.ratio.value_or(0), 1 / 1.023, 0.013);
}

}  // namespace
}  // namespace todbench
