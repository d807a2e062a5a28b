// SPDX-License-Identifier: GPL-3.0-or-later
// The planner of effects against brute force: on the grid that its bounds were set with, and on scenes of which nothing
// was used for that. Prints every result, and per set what docs/validation/sensor-model.md states.
#include <gmock/gmock.h>

#include <cstdio>
#include <map>

#include "tests/sim_devices/prediction/effect_grid.h"

namespace todbench {
namespace {

struct StudyDraws {
  int seeds = 2, draws = 200;
};

struct Summary {
  double largest_share = 0;  ///< of true change over tolerance
  double largest_percent = 0;
  double brute_s = 0, planned_s = 0, planning_s = 0;
  int above_bound = 0;  ///< true changes that exceed the promised bound (and a fifth of the tolerance) by 2 sigma
  int skipped = 0, scenes = 0;
};

int skipped_effects(const EffectPlan& plan, const test::GridScene& scene) {
  int count = 0;
  for (const auto& d : plan.plan.decisions) {
    if (d.decision == Decision::skip && !is_neutral(scene.sensor, d.effect, scene.motion)) ++count;
  }
  return count;
}

void hold_against_brute_force(const test::GridScene& scene, test::Observers& observers,
                              std::map<double, Summary>& summaries, const StudyDraws& noise = {}) {
  TemplateObserver& observer = observers.of(scene.observer);
  test::BruteForce brute(scene, observer, noise.seeds, noise.draws);
  for (const double tolerance : {1.0, 2.0, 5.0}) {
    const std::clock_t begin = std::clock();
    const auto plan = test::planned(scene, observer, tolerance);
    const double planning_s = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    ASSERT_TRUE(plan.has_value()) << scene.name << ": " << plan.error().message;
    const auto change = brute.change(plan->plan, tolerance);

    EXPECT_LE(std::abs(change.percent), tolerance) << scene.name;
    Summary& s = summaries[tolerance];
    s.largest_percent = std::max(s.largest_percent, std::abs(change.percent));
    s.largest_share = std::max(s.largest_share, std::abs(change.percent) / tolerance);
    s.brute_s += change.brute_s;
    s.planned_s += change.planned_s;
    s.planning_s += planning_s;
    s.skipped += skipped_effects(*plan, scene);
    ++s.scenes;
    if (std::abs(change.percent) - 2 * change.standard_error > plan->skipped_change_percent + 0.2 * tolerance)
      ++s.above_bound;
    std::printf("%s tolerance %.0f %%: bound %.2f %%, true change %+.2f +- %.2f %%, time %.2f of %.2f s, skipped",
                scene.name.c_str(), tolerance, plan->skipped_change_percent, change.percent, change.standard_error,
                change.planned_s, change.brute_s);
    for (const auto& d : plan->plan.decisions) {
      if (d.decision == Decision::skip && !is_neutral(scene.sensor, d.effect, scene.motion))
        std::printf(" %s %.2g", std::string(to_string(d.effect)).c_str(), *d.predicted_change_percent);
    }
    std::printf("\n");
    std::fflush(stdout);
  }
}

void print(const char* title, const std::map<double, Summary>& summaries) {
  for (const auto& [tolerance, s] : summaries) {
    std::printf(
        "%s, tolerance %.0f %%: %d scenes, largest true change %.2f %% (%.2f of the tolerance), %d above bound and "
        "numerical share, %.1f effects skipped per scene, %.1f s (and %.1f s planning) instead of %.1f s\n",
        title, tolerance, s.scenes, s.largest_percent, s.largest_share, s.above_bound,
        static_cast<double>(s.skipped) / s.scenes, s.planned_s, s.planning_s, s.brute_s);
  }
}

TEST(EffectPlannerStudy, TheTrueChangeStaysWithinTheToleranceInEverySceneOfTheGrid) {
  test::Observers observers;
  std::map<double, Summary> summaries;
  for (const auto& scene : test::all_scenes()) hold_against_brute_force(scene, observers, summaries);
  print("grid", summaries);
}

TEST(EffectPlannerStudy, TheTrueChangeStaysWithinTheToleranceInEveryFreshScene) {
  constexpr std::uint64_t set = 1, scenes = 72;
  test::Observers observers;
  std::map<double, Summary> summaries;
  for (std::uint64_t k = 0; k < scenes; ++k) hold_against_brute_force(test::random_scene(set, k), observers, summaries);
  print("fresh", summaries);
}

/// Sixty scenes take twenty minutes: ten at a time, each a test of its own.
class EffectPlannerAirStudy : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(EffectPlannerAirStudy, TheTrueChangeStaysWithinTheToleranceInEverySceneBehindAir) {
  constexpr std::uint64_t set = 2, scenes = 10;
  test::Observers observers;
  std::map<double, Summary> summaries;
  for (std::uint64_t k = GetParam(); k < GetParam() + scenes; ++k)
    hold_against_brute_force(test::random_air_scene(set, k), observers, summaries);
  print("air", summaries);
}

INSTANTIATE_TEST_SUITE_P(Scenes, EffectPlannerAirStudy, ::testing::Values(0, 10, 20, 30, 40, 50),
                         ::testing::PrintToStringParamName());

/// With and without the dance all draws are the same, so fewer of them do; frames that dance cost four times as much.
class EffectPlannerDanceStudy : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(EffectPlannerDanceStudy, TheTrueChangeStaysWithinTheToleranceInEverySceneWhoseFramesDance) {
  constexpr std::uint64_t set = 3, scenes = 5;
  test::Observers observers;
  std::map<double, Summary> summaries;
  for (std::uint64_t k = GetParam(); k < GetParam() + scenes; ++k)
    hold_against_brute_force(test::random_dance_scene(set, k), observers, summaries, {.seeds = 1, .draws = 60});
  print("dance", summaries);
}

INSTANTIATE_TEST_SUITE_P(Scenes, EffectPlannerDanceStudy, ::testing::Values(0, 5, 10, 15, 20, 25),
                         ::testing::PrintToStringParamName());

}  // namespace
}  // namespace todbench
