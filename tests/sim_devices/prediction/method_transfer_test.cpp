// SPDX-License-Identifier: GPL-3.0-or-later
// Short form of method_transfer_study: one imager, two contrasts.
#include "tests/sim_devices/prediction/observer_ranking.h"
#include "tests/sim_devices/prediction/transfer_fit.h"

namespace todbench::testing {
namespace {

TEST(MethodTransfer, HoldsForOneImagerAtTwoContrasts) {
  const SensorSpec sensor = studied_imagers()[7];
  const MethodDesign design{
      .accuracy = Accuracy::draft(), .bar_draws = 200, .seed = 11, .over_netd = {8, 60}, .of_nyquist = {0.9, 1.1, 1.3}};

  const auto points = method_points(sensor, {}, design);

  ASSERT_EQ(points.size(), 2U);
  for (const MethodPoint& point : points)
    EXPECT_LT(std::abs(residual(tod_transfers().front(), point)), tod_transfers().front().half_width_ln)
        << point.over_netd;
  EXPECT_LT(points.front().acuity_share, 0.9) << "both contrasts are on the asymptote";
}

TEST(ObserverRankings, TheIdealObserverIsBelowTheTemplates) {
  const SensorSpec sensor = studied_imagers()[1];
  TemplateObserver templates({}, triangle_alternatives());
  const auto found =
      direct_estimate(sensor, full_plan(sensor, {}, {}), templates, {0.2}, {.accuracy = Accuracy::draft()});

  const double ideal = ideal_s75_pitch(ShownTriangles(sensor, Accuracy::draft()), 0.2);

  ASSERT_TRUE(found);
  EXPECT_LT(ideal, found->front().s75_pitch);
  // Noise over contrast of 0.35: the observer of the known position needs 2.4 pitches (docs/validation/ranges.md).
  EXPECT_NEAR(ideal, 2.42, 0.05);
}

}  // namespace
}  // namespace todbench::testing
