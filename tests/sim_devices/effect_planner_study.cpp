// The whole grid: 72 scenes at three tolerances, with the time that the plan saves.
#include <gmock/gmock.h>

#include <cstdio>
#include <map>

#include "tests/sim_devices/effect_grid.h"

namespace todbench {
namespace {

TEST(EffectPlannerStudy, TheTrueChangeStaysWithinTheToleranceInEveryScene) {
  const std::vector<double> tolerances{1, 2, 5};
  std::map<double, double> largest, brute_s, planned_s;
  std::map<double, int> skipped;
  for (const auto& scene : test::all_scenes()) {
    test::BruteForce brute(scene, 2, 100);
    for (const double tolerance : tolerances) {
      const auto plan = test::planned(scene, brute.observer(), tolerance);
      ASSERT_TRUE(plan.has_value()) << plan.error().message;
      const auto change = brute.change(plan->plan);

      EXPECT_LE(std::abs(change.percent), tolerance) << scene.name;
      largest[tolerance] = std::max(largest[tolerance], std::abs(change.percent));
      brute_s[tolerance] += change.brute_s;
      planned_s[tolerance] += change.planned_s;
      for (const auto& d : plan->plan.decisions) {
        if (d.decision == Decision::skip && !is_neutral(scene.sensor, d.effect, scene.motion)) ++skipped[tolerance];
      }
      std::printf("%-40s tolerance %3.0f %%: bound %5.2f %%, true change %+6.2f +- %.2f %%, time %.2f of %.2f s\n",
                  scene.name.c_str(), tolerance, plan->skipped_change_percent, change.percent, change.standard_error,
                  change.planned_s, change.brute_s);
    }
  }
  for (const double tolerance : tolerances) {
    std::printf(
        "tolerance %.0f %%: largest true change %.2f %%, %.1f effects skipped per scene, %.1f s instead of %.1f s\n",
        tolerance, largest[tolerance], skipped[tolerance] / 72.0, planned_s[tolerance], brute_s[tolerance]);
  }
}

}  // namespace
}  // namespace todbench
