// SPDX-License-Identifier: GPL-3.0-or-later
// Commands that judge pictures behind stages, with every shipped observer: x -> gain x + offset moves no acuity, and a
// linear filter followed by its inverse changes nothing. An observer with an eye judges the display of the plan,
// whose span is in kelvin of the judged contrast: a gain of the stages is no gain of the display. Not here: simulate
// and measure with modules (tests/system/module_test.cpp); judge, blind and recorded sessions
// (recorded_scale_test.cpp); noise (real_noise_test.cpp). mrtd, naked-eye, range, round-robin, reference-set and the
// MRTD of a session judge pictures without stages: there a gain is a camera of another responsivity, which must change
// the result.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "bench/enhance/decidable.h"
#include "bench/model_comparison/model_comparison.h"
#include "bench/scene_dependence/scene_dependence.h"
#include "bench/studies/staged_scene.h"
#include "sim_devices/prediction/dynamic_trials.h"
#include "sim_devices/prediction/identification.h"
#include "tests/bench/enhance/scale_invariance.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

using namespace testing_support;

const EnhancementPackage back_and_forth = package_of({kernel_of(shift_right), kernel_of(shift_left)}, "inverse");

/// x -> gain x + offset by a program.
EnhancementPackage affine_package(const std::string& gain_and_offset) {
  StagePlan stage{.kind = StagePlan::Kind::module};
  stage.module.process.command = TODBENCH_MODULE_EXAMPLE " affine=" + gain_and_offset;
  stage.module.process.limit = std::chrono::seconds(60);
  return package_of({stage}, gain_and_offset);
}

/// Whole counts of 1 mK add 2e-4 to the variance of a noise of 70 mK at a gain of 0.3. That turns an answer in which
/// two alternatives are equal within 1e-4: at most one of 60.
constexpr double most_turned = 1.0 / 60;

TEST(EveryObserver, OfEnhanceSeesNoGainNoOffsetAndNoFilterWithItsInverse) {
  for (const std::string& observer : resource_names(ResourceKind::observer)) {
    // The surround is at 10000 counts, the triangles at 14000, full scale at 65535.
    const auto found =
        compare_packages(plan_of_counts(observer, 3, 1, 0.001),
                         {affine_package("0.3,5000"), affine_package("3,-5000"), back_and_forth}, {}, {});

    ASSERT_TRUE(found) << observer << ": " << found.error().message;
    const PackageResult& none = found->results[0];
    for (std::size_t i = 1; i < found->results.size(); ++i) {
      const PackageResult& result = found->results[i];
      ASSERT_FALSE(result.error) << observer << ": " << result.error->message;
      const Moved moved = moved_by(result, none);
      EXPECT_LE(moved.answers, result.name == "inverse" ? 0 : most_turned) << observer << " " << result.name;
      // 60 answers of an observer may leave the ratio without an interval.
      EXPECT_LE(std::abs(moved.ln_ratio), moved.half_width.value_or(0.02)) << observer << " " << result.name;
      EXPECT_NEAR(judged_point(result, 4)->noise_k / judged_point(found->results[3], 4)->noise_k, 1, 0.005) << observer;
    }
  }
}

TEST(EveryObserver, OfCompareModelsSeesNoGainNoOffsetAndNoFilterWithItsInverse) {
  const auto model = [](const EnhancementPackage& package) {
    ComparedModel out;
    out.kind = ModelKind::package;
    out.name = package.name;
    out.package = package;
    return out;
  };
  for (const std::string& observer : resource_names(ResourceKind::observer)) {
    const auto found = compare_models(plan_of_counts(observer, 3, 1, 0.001), model(back_and_forth),
                                      model(affine_package("0.3,5000")), {}, {});

    ASSERT_TRUE(found) << observer << ": " << found.error().message;
    ASSERT_TRUE(found->ratios.at(0).ratio) << observer << ": " << found->ratios.at(0).withheld;
    EXPECT_FALSE(parts(found->ratios.at(0)).value_or(false)) << observer;
    EXPECT_NEAR(*found->ratios.at(0).ratio, 1, 0.02) << observer;
  }
}

/// Right answers of each size and kind of observer, over all passes.
std::vector<double> right_answers(const SensorSpec& sensor, const TemplateObserverSpec& spec,
                                  const DynamicTrialOptions& options) {
  TemplateObserver observer(spec, triangle_alternatives());
  const auto found = dynamic_trials(sensor, observer, options);
  EXPECT_TRUE(found) << spec.name << ": " << found.error().message;
  std::vector<double> correct;
  if (!found) return correct;
  for (const DynamicTrials& at : *found) {
    for (const auto& levels : at.levels) {
      double sum = 0;
      for (const Level& level : levels) sum += level.correct;
      correct.push_back(sum);
    }
  }
  return correct;
}

TEST(EveryObserver, OfDynamicSeesNoGainNoOffsetAndNoFilterWithItsInverse) {
  const SensorSpec sensor = small_plan("4", 2).sensor();
  DynamicTrialOptions options{.delta_t_k = 4,
                              .sizes_pitch = {1.3, 1.8, 2.4, 3},
                              .speeds_mrad_s = {0, 20},
                              .passes = 6,
                              .frames = 2,
                              .accuracy = Accuracy::draft()};
  for (const TemplateObserverSpec& observer : shipped_observers()) {
    options.stages = {};
    const std::vector<double> plain = right_answers(sensor, observer, options);
    for (const StageMaker& stages : {affine(0.3, 5000), affine(-3, 60000), filter_and_inverse()}) {
      options.stages = stages;
      // Nothing is rounded behind the stages: single precision alone differs.
      EXPECT_THAT(right_answers(sensor, observer, options), ::testing::Pointwise(::testing::DoubleNear(1), plain))
          << observer.name;
    }
  }
}

FieldScene warm_triangle_towards(Apex apex) {
  FieldScene scene;
  scene.background_k = 300;
  scene.regions = {{"triangle", triangle(1, apex), 300.6, 1, true}};
  return scene;
}

TEST(EveryObserver, OfIdentifySeesNoGainNoOffsetAndNoFilterWithItsInverse) {
  IdentificationTask task;
  task.sensor = small_plan("4", 2).sensor();
  task.sensor.width = 64, task.sensor.height = 48;
  task.plan = full_plan(task.sensor, {}, {});
  task.accuracy = Accuracy::draft();
  for (const Apex apex : all_apexes)
    task.targets.push_back({std::to_string(static_cast<int>(apex)), {warm_triangle_towards(apex)}});
  task.ranges = {{400, 1}};
  task.decisions = 80;
  task.stage_reach_px = 4;
  for (const TemplateObserverSpec& observer : shipped_observers()) {
    const std::string& name = observer.name;
    task.observer = observer;
    task.observer.search_range_samples = 0.25;
    task.stages = affine(1, 0);
    const auto same = identify(task);
    ASSERT_TRUE(same) << name << ": " << same.error().message;
    EXPECT_LT(same->front().proportion(), 0.95) << "noise has to turn answers";
    for (const StageMaker& stages : {affine(0.3, 5000), affine(-3, 60000), filter_and_inverse()}) {
      task.stages = stages;
      const auto found = identify(task);
      ASSERT_TRUE(found) << name << ": " << found.error().message;
      EXPECT_EQ(found->front().answers, same->front().answers) << name;
      EXPECT_NEAR(found->front().judged->noise_k / same->front().judged->noise_k, 1, 1e-3) << name;
    }
  }
}

TEST(SceneDependence, BehindAGainAnOffsetOrAFilterWithItsInverseIsThatOfTheCamera) {
  const auto plan = plan_of_counts("hvs-1", 2, 1, 0.001);
  const SceneDependenceOptions options{.cycles = 3, .frames = 4};
  const auto none = plan_scene_dependence(plan, nullptr, 10, options, {}, {});
  ASSERT_TRUE(none) << none.error().message;
  for (const EnhancementPackage& package : {affine_package("0.3,5000"), affine_package("2,-5000"), back_and_forth}) {
    const auto found = plan_scene_dependence(plan, &package, 10, options, {}, {});

    ASSERT_TRUE(found) << package.name << ": " << found.error().message;
    ASSERT_EQ(found->sizes.size(), none->sizes.size());
    // The frames are the same, rounded once more.
    for (std::size_t i = 0; i < none->sizes.size(); ++i)
      EXPECT_NEAR(found->sizes[i].ratio, none->sizes[i].ratio, 1e-3) << package.name << " " << none->sizes[i].size_mm;
  }
}

TEST(StagedScene, BehindAGainAnOffsetOrAFilterWithItsInverseIsThatOfTheCamera) {
  SensorSpec sensor = small_plan("4", 2).sensor();
  sensor.width = 64, sensor.height = 48;
  const SensorModel model(sensor, full_plan(sensor, {}, {}), Accuracy::draft(), 1);
  cv::Mat1f signal = cv::Mat1f::zeros(model.size());
  signal(cv::Rect(20, 15, 12, 9)) = 4;
  const cv::Rect field(10, 8, 40, 30);
  const auto seen = [&](const StageMaker& stages) {
    return behind_stages(model, stages, {signal}, 300, field).value();
  };
  const StagedFrame plain = seen(affine(1, 0));
  for (const StageMaker& stages : {affine(0.3, 5000), affine(-3, 60000), filter_and_inverse()}) {
    // Single precision at 60000 counts: 4e-3 counts of 10 mK.
    EXPECT_LT(cv::norm(seen(stages).kelvin(field), plain.kelvin(field), cv::NORM_INF), 1e-3);
  }
}

}  // namespace
}  // namespace todbench
