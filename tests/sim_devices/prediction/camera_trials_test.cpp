// SPDX-License-Identifier: GPL-3.0-or-later
// The observer before an emulated camera, single pictures and super-resolved ones.
#include "sim_devices/prediction/camera_trials.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim_devices/reference.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

double share(const std::vector<Level>& levels, double size_mrad) {
  double correct = 0, total = 0;
  for (const auto& level : levels) {
    if (std::abs(level.size - size_mrad) > 1e-9) continue;
    correct += level.correct, total += level.total;
  }
  return correct / total;
}

TEST(CameraTrials, SuperResolutionAveragesNoiseAndResolvesMore) {
  TemplateObserver observer({}, triangle_alternatives());
  const SensorSpec sensor = test::sc2000();
  const CameraTrialOptions options{
      .delta_t_k = 0.23, .sizes_pitch = {1.5, 4.5}, .presentations = 6, .frames = 16, .accuracy = Accuracy::draft()};

  const auto found = camera_trials(sensor, {&observer}, options);

  // 16 frames over 4 cells. Known thresholds (direct estimate): 2.64 pitches still, well below 2 super-resolved. At 1.5
  // pitches 24 answers: the chance of a single picture being right as often as a super-resolved one is below 1e-4.
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_LE(found->frames_per_sample, 4.0);
  EXPECT_GT(found->frames_per_sample, 3.2);
  EXPECT_LT(found->registration_rms_px, 0.15);
  EXPECT_LT(found->placement_rms_px, 1 / std::sqrt(48.0) + 0.01);  // shifts anywhere: half a pitch over sqrt(12)
  const auto& trials = found->observers.front();
  ASSERT_EQ(trials.still.levels.size(), 12u);
  ASSERT_EQ(trials.super_resolved.levels.size(), 12u);
  const double small = 1.5 * sensor.ifov_mrad(), large = 4.5 * sensor.ifov_mrad();
  EXPECT_GT(share(trials.super_resolved.levels, small), share(trials.still.levels, small));
  EXPECT_GT(share(trials.still.levels, large), 0.85);
  EXPECT_GT(share(trials.super_resolved.levels, large), 0.95);
}

TEST(CameraTrials, GradedAnswersScatterLessAboutTheSameProportions) {
  TemplateObserver observer({}, triangle_alternatives());
  const SensorSpec sensor = test::sc2000();
  const auto found = camera_trials(
      sensor, {&observer},
      {.delta_t_k = 0.23, .sizes_pitch = {2.6}, .presentations = 30, .frames = 16, .accuracy = Accuracy::draft()});

  ASSERT_TRUE(found) << found.error().message;
  for (const PictureAnswers* answers : {&found->observers[0].still, &found->observers[0].super_resolved}) {
    ASSERT_EQ(answers->graded.size(), 120u);
    double graded = 0, squares = 0;
    for (const GradedAnswer& answer : answers->graded) graded += answer.probability_correct / 120;
    for (const GradedAnswer& answer : answers->graded)
      squares += std::pow(answer.probability_correct - graded, 2) / 120;
    const double right = share(answers->levels, answers->graded[0].size), chance = graded * (1 - graded);
    EXPECT_LT(squares, 0.8 * chance) << "right and wrong ones scatter by p (1 - p)";
    EXPECT_NEAR(right, graded, 4 * std::sqrt((chance - squares) / 120)) << "what is left between the two is chance";
  }
}

TEST(CameraTrials, ExactHalfPitchesPutEverySampleOnTheFineGridAndResolveMore) {
  TemplateObserver observer({}, triangle_alternatives());
  const SensorSpec sensor = test::sc2000();
  CameraTrialOptions options{
      .delta_t_k = 16.9, .sizes_pitch = {0.9, 1.0}, .presentations = 12, .frames = 8, .accuracy = Accuracy::draft()};
  const auto anywhere = camera_trials(sensor, {&observer}, options);
  options.displacements = FrameDisplacements::half_pitches;

  const auto exact = camera_trials(sensor, {&observer}, options);

  ASSERT_TRUE(anywhere && exact);
  EXPECT_LT(exact->placement_rms_px, 0.02);  // what the registration is wrong by
  EXPECT_GT(anywhere->placement_rms_px, 0.08);
  // Thresholds 1.01 and 1.09 pitches with slopes near 5: 0.11 of the answers between them, 48 answers each at 2 sizes.
  double exact_right = 0, anywhere_right = 0;
  for (const auto& level : exact->observers[0].super_resolved.levels) exact_right += level.correct;
  for (const auto& level : anywhere->observers[0].super_resolved.levels) anywhere_right += level.correct;
  EXPECT_GT(exact_right, anywhere_right);
}

TEST(CameraTrials, RefusesWhatHasNoMeaning) {
  TemplateObserver observer({}, triangle_alternatives());
  const SensorSpec sensor = test::sc2000();
  SensorSpec microscan = sensor;
  microscan.microscan = 2;

  EXPECT_FALSE(camera_trials(sensor, {&observer}, {.delta_t_k = 0, .sizes_pitch = {2}, .accuracy = {}}).has_value());
  EXPECT_FALSE(camera_trials(sensor, {&observer}, {.delta_t_k = 1, .sizes_pitch = {}, .accuracy = {}}).has_value());
  EXPECT_FALSE(camera_trials(microscan, {&observer}, {.delta_t_k = 1, .sizes_pitch = {2}, .accuracy = {}}).has_value());
}

}  // namespace
}  // namespace todbench
