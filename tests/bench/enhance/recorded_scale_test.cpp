// SPDX-License-Identifier: GPL-3.0-or-later
// Recorded frames judged again behind stages: x -> gain x + offset and a linear filter with its inverse change neither
// the answers of an observer nor the pictures that a person is shown.
#include <gtest/gtest.h>

#include <cmath>

#include "bench/enhance/blind_judgement.h"
#include "bench/enhance/judge_again.h"
#include "tests/bench/enhance/scale_invariance.h"
#include "tests/bench/run/measured_session.h"

namespace todbench {
namespace {

using namespace testing_support;

class RecordedScale : public testing::MeasuredSession {
 protected:
  RecordedScale() {
    plan_.schedule.answers = AnswersChoice::binary;
    plan_.schedule.frames_per_presentation = {0};
    plan_.target.delta_t_k = {16.9};
    plan_.target.phases = 2;
    plan_.simulation.phases = 1;
  }
};

/// The surround is at 5000 of 16383 counts of 10 mK, the triangles at 6690. Whole counts behind the gain add 0.04 % to
/// the variance of the noise, and offsets are whole counts.
EnhancementPackage doubled_and_shifted() {
  StagePlan stage{.kind = StagePlan::Kind::module};
  stage.module.process.command = TODBENCH_MODULE_EXAMPLE " affine=2,-3000";
  stage.module.process.limit = std::chrono::seconds(60);
  return package_of({stage}, "affine");
}

EnhancementPackage filtered_and_back() {
  return package_of({kernel_of(shift_right), kernel_of(shift_left)}, "inverse");
}

TEST_F(RecordedScale, OfStagesChangesNoAnswerOfAnyObserverThatJudgesAgain) {
  ASSERT_TRUE(measure("m"));
  const auto answers = [&](const std::string& observer, const EnhancementPackage& package) {
    std::vector<Apex> out;
    const auto run = judge_again(at("m"), {.observer = observer, .package = package, .display = operators_display()},
                                 options(observer + package.name), {}, {});
    EXPECT_TRUE(run) << observer << " " << package.name << ": " << run.error().message;
    if (!run) return out;
    for (const Trial& trial : read_session(at(observer + package.name)).value().trials) out.push_back(trial.answer);
    return out;
  };
  const EnhancementPackage same = package_of({kernel_of({0, 0, 0, 0, 1, 0, 0, 0, 0})}, "same");
  for (const std::string& observer : resource_names(ResourceKind::observer)) {
    const auto plain = answers(observer, same), affine = answers(observer, doubled_and_shifted());

    ASSERT_EQ(plain.size(), 40u);
    EXPECT_EQ(affine, plain) << observer;
    if (observer == "human-like-1") {
      EXPECT_EQ(answers(observer, filtered_and_back()), plain);
    }
  }
}

TEST_F(RecordedScale, OfStagesChangesNoPictureThatAPersonIsShown) {
  ASSERT_TRUE(measure("m"));

  const auto sources = blind_sources(at("m"), {doubled_and_shifted(), filtered_and_back()}, false, at("b"), {}, {});

  ASSERT_TRUE(sources) << sources.error().message;
  const auto& camera = sources->front().trials;
  for (std::size_t s = 1; s < sources->size(); ++s) {
    const auto& behind = (*sources)[s].trials;
    ASSERT_EQ(behind.size(), camera.size());
    for (std::size_t i = 0; i < camera.size(); ++i) {
      EXPECT_EQ(behind[i].trial.delta_t_k, camera[i].trial.delta_t_k);
      EXPECT_NEAR(behind[i].noise_k / camera[i].noise_k, 1, 0.01);
      // An offset of the whole picture is none for a person: the grey scale is centred on the surround.
      cv::Mat1d one(camera[i].patch_k), other(behind[i].patch_k);
      one -= cv::mean(one)[0];
      other -= cv::mean(other)[0];
      // The gain of 16.9 K is measured to 1e-3.
      EXPECT_LT(cv::norm(one, other, cv::NORM_INF), 0.02) << (*sources)[s].name << " " << i;
    }
  }
}

TEST_F(RecordedScale, OfStagesChangesNoAnswerOfPackagesThatAreCompared) {
  ASSERT_TRUE(measure("m"));
  const auto loaded = recorded_plan(at("m"), {});
  ASSERT_TRUE(loaded) << loaded.error().message;

  const auto found = compare_packages_recorded(at("m"), *loaded, {doubled_and_shifted(), filtered_and_back()}, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  const auto& camera = found->results.front().trials;
  for (const PackageResult& result : found->results) {
    ASSERT_FALSE(result.error) << result.error->message;
    ASSERT_EQ(result.trials.size(), camera.size());
    for (std::size_t i = 0; i < camera.size(); ++i)
      EXPECT_EQ(result.trials[i].answer, camera[i].answer) << result.name << " " << i;
  }
}

}  // namespace
}  // namespace todbench
