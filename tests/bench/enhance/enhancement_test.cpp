// SPDX-License-Identifier: GPL-3.0-or-later
// Enhancement under test: what must not change anything does not, what is known comes out.
#include "bench/enhance/enhancement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <signal.h>

#include <cmath>

#include "bench/enhance/enhancement_page.h"
#include "bench/enhance/package_spread.h"
#include "bench/enhance/unseen_differences.h"
#include "bench/report/html.h"
#include "hvs/observer/open_parameters.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "tests/bench/enhance/enhancement_support.h"
#include "tests/bench/enhance/paired_ratio_coverage.h"
#include "tests/support/source_file.h"
#include "tests/support/temporary_folder.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryFolder;
using namespace testing_support;

TEST(Enhancement, ByMeasuredShiftsOutlivesChangesOfTheTargetButNotACameraThatRests) {
  const auto plan = small_plan("16.9", 3, "[measurement]\nregistration_frames = 8\ncontrast_frames = 4\n");
  const StagePlan measured{.kind = StagePlan::Kind::super_resolution,
                           .super_resolution = {.frames = 4, .factor = 2, .shifts = FrameShifts::measured}};

  const auto moved = compare_packages(plan, {package_of({measured})}, {.dither = 2}, {});
  const auto at_rest = compare_packages(plan, {package_of({measured})}, {}, {});

  ASSERT_TRUE(moved) << moved.error().message;
  EXPECT_FALSE(moved->results[1].error) << moved->results[1].error->message;
  EXPECT_EQ(moved->results[1].trials.size(), 3u * 20);
  ASSERT_TRUE(at_rest) << at_rest.error().message;
  ASSERT_TRUE(at_rest->results[1].error) << "three cells of a pixel have no frame";
  EXPECT_EQ(at_rest->results[1].error->code, ErrorCode::integrity);
  EXPECT_TRUE(at_rest->results[1].trials.empty());
}

TEST(Enhancement, BySuperResolutionOfADitheredSensorIsThatOfFinerSampling) {
  const auto plan = small_plan("0.6", 8);
  const StagePlan finer{.kind = StagePlan::Kind::super_resolution,
                        .super_resolution = {.frames = 4, .factor = 2, .shifts = FrameShifts::scan}};

  const auto found = compare_packages(plan, {package_of({finer})}, {.dither = 2}, {});

  ASSERT_TRUE(found) << found.error().message;
  const PackageResult& result = found->results[1];
  ASSERT_FALSE(result.error) << result.error->message;
  EXPECT_EQ(result.samples_per_pixel, 2);
  EXPECT_EQ(result.trials.size(), 8u * 20);
  SensorSpec fine = plan.sensor();
  fine.super_resolution_frames = 4;
  TemplateObserver observer(plan.observer(), triangle_alternatives());
  const auto direct =
      direct_estimate(fine, full_plan(fine, {}, {}), observer, {0.6}, {.accuracy = Accuracy::draft(), .seed = 1});
  ASSERT_TRUE(direct) << direct.error().message;
  const PsychometricFit& fit = result.curve.points.front().fit;
  const double expected_mrad = direct->front().s75_pitch * fine.ifov_mrad();
  EXPECT_LT(fit.ci95.low.value(), expected_mrad);
  EXPECT_GT(fit.ci95.high.value(), expected_mrad);
  // Pixels are those of the camera, and its contrast: sizes are the same in both.
  EXPECT_EQ(result.trials.front().size_px, found->results[0].trials.front().size_px);
  EXPECT_NEAR(result.curve.points.front().delta_t_k / 0.6, 1, 0.03);
  EXPECT_LT(fit.ci95.high.value(), found->results[0].curve.points.front().fit.ci95.low.value())
      << "finer sampling resolves more";
  const auto at_rest = compare_packages(plan, {package_of({finer})}, {}, {});
  ASSERT_FALSE(at_rest) << "a scan of a sensor that does not scan";
  EXPECT_EQ(at_rest.error().code, ErrorCode::invalid_input);
}

TEST(Enhancement, OfNeutralStagesChangesNoAnswer) {
  const auto plan = small_plan("16.9", 2);
  StagePlan all{.kind = StagePlan::Kind::recursive, .share = 1}, none{.kind = StagePlan::Kind::sharpen, .amount = 0};

  const auto found = compare_packages(plan, {package_of({all, none})}, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  ASSERT_EQ(found->results.size(), 2u);
  ASSERT_FALSE(found->results[1].error) << found->results[1].error->message;
  EXPECT_GT(found->results[0].trials.size(), 10u);
  ASSERT_EQ(found->results[0].trials.size(), found->results[1].trials.size());
  for (std::size_t i = 0; i < found->results[0].trials.size(); ++i)
    EXPECT_EQ(found->results[0].trials[i].scores, found->results[1].trials[i].scores);
  for (const auto& ratio : found->results[1].ratios) {
    EXPECT_EQ(ratio.ratio.value_or(1), 1);
  }
}

TEST(Enhancement, ByARecursiveFilterIsThatOfLessNoise) {
  // The noise that a share of a third leaves has the standard deviation sqrt(1/5) = 0.447.
  const auto plan = small_plan("0.6", 8);
  StagePlan third{.kind = StagePlan::Kind::recursive, .share = 1.0 / 3};

  const auto found = compare_packages(plan, {package_of({third})}, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->settle_frames, 18);
  ASSERT_EQ(found->results[1].ratios.size(), 1u);
  const auto& ratio = found->results[1].ratios[0];
  ASSERT_TRUE(ratio.ratio && ratio.ci95.low);
  EXPECT_GT(*ratio.ci95.low, 1) << "less noise, better acuity";

  PlanParts parts = plan.parts();
  parts.sensor.netd_k *= std::sqrt(0.2);
  const auto quiet = compare_packages(LoadedPlan::of(plan.plan(), parts).value(), {}, {}, {});
  ASSERT_TRUE(quiet) << quiet.error().message;
  const auto &filtered_fit = found->results[1].curve.points.at(0).fit,
             &quiet_fit = quiet->results[0].curve.points.at(0).fit;
  ASSERT_TRUE(filtered_fit.threshold && quiet_fit.threshold);
  const double se = std::hypot(filtered_fit.se_ln_threshold.value(), quiet_fit.se_ln_threshold.value());
  EXPECT_NEAR(std::log(*filtered_fit.threshold / *quiet_fit.threshold), 0, 4 * se);
}

TEST(Enhancement, IsSeenByAnObserverWithAnEyeAtTheDisplayOfThePlan) {
  // A filter that is neutral changes nothing; one that blurs costs acuity where the eye does not limit it.
  const auto plan = small_plan("16.9", 6,
                               "[observer]\nname = \"hvs-2\"\n[display]\npixel_pitch_mm = 0.27\nviewing_distance_m = "
                               "0.5\nzoom = 3\nluminance_white_cd_m2 = 200\n");
  StagePlan neutral{.kind = StagePlan::Kind::sharpen, .amount = 0};
  StagePlan blurred{.kind = StagePlan::Kind::kernel};
  blurred.kernel.fill(1.0 / 9);

  const auto found =
      compare_packages(plan, {package_of({neutral}, "neutral"), package_of({blurred}, "blurred")}, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  ASSERT_EQ(found->results.size(), 3u);
  for (const auto& ratio : found->results[1].ratios) EXPECT_EQ(ratio.ratio.value_or(1), 1);
  ASSERT_EQ(found->results[2].ratios.size(), 1u);
  // Few answers have no interval; the ratio is about a half.
  EXPECT_LT(found->results[2].ratios[0].ratio.value_or(1), 0.8) << "a blurred picture shows less";
  EXPECT_TRUE(any_spread(*found));
  for (const PackageResult& result : found->results) {
    const TodPoint& point = result.curve.points.at(0);
    ASSERT_TRUE(point.s75_spread_mrad) << result.name;
    EXPECT_LE(point.s75_spread_mrad->first, point.fit.threshold.value());
    EXPECT_GE(point.s75_spread_mrad->second, point.fit.threshold.value());
    EXPECT_LT(point.s75_spread_mrad->first, point.s75_spread_mrad->second) << result.name;
  }
  EXPECT_EQ(found->results[1].curve.points[0].s75_spread_mrad, found->results[0].curve.points[0].s75_spread_mrad);
  EXPECT_EQ(found->results[1].ratios[0].spread, std::pair(1.0, 1.0));
  // Both thresholds move together: the ratio moves less than either.
  const auto& [low, high] = found->results[2].curve.points[0].s75_spread_mrad.value();
  const auto& ratios = found->results[2].ratios[0].spread.value();
  EXPECT_LT(ratios.second / ratios.first, high / low);
  EXPECT_THAT(render_html(enhancement_page(plan, {}, *found)), HasSubstr("Ratio, open parameters"));
  EXPECT_FALSE(any_spread(compare_packages(small_plan("16.9", 1), {}, {}, {}).value())) << "hvs-1 has no eye";
}

TEST(Enhancement, AsksAnEndOfTheOpenParametersAsIfItWereTheObserver) {
  const auto plan = small_plan("0.6", 2,
                               "[observer]\nname = \"hvs-2\"\n[display]\npixel_pitch_mm = 0.27\nviewing_distance_m = "
                               "0.5\nzoom = 3\nluminance_white_cd_m2 = 200\n");
  const auto found = compare_packages(plan, {}, {}, {});
  PlanParts parts = plan.parts();
  parts.observer = open_parameter_range(plan.observer())->worst;
  const auto alone = compare_packages(LoadedPlan::of(plan.plan(), parts).value(), {}, {}, {});

  ASSERT_TRUE(found && alone);
  const auto &asked = found->results[0].at_ends.trials[1], &expected = alone->results[0].trials;
  ASSERT_EQ(asked.size(), 40u);
  ASSERT_EQ(expected.size(), 40u);
  for (std::size_t i = 0; i < asked.size(); ++i) {
    EXPECT_EQ(asked[i].scores, expected[i].scores) << i;
    EXPECT_EQ(asked[i].answer, expected[i].answer) << i;
  }
}

TEST(Enhancement, KeepsTheTrialsOfAPackageThatFailsAndGoesOn) {
  ::signal(SIGPIPE, SIG_IGN);
  const auto plan = small_plan("16.9", 2);
  // Registration takes 32 frames, the contrast 16, every presentation one: it ends with the second.
  StagePlan module{.kind = StagePlan::Kind::module};
  module.module.process.command = TODBENCH_MODULE_EXAMPLE " ends 49";
  module.module.process.limit = std::chrono::seconds(60);
  StagePlan dead{.kind = StagePlan::Kind::module};
  dead.module.process.command = TODBENCH_MODULE_EXAMPLE " crash";
  StagePlan restarted{.kind = StagePlan::Kind::module};
  restarted.module.process.command = TODBENCH_MODULE_EXAMPLE " identity";
  restarted.module.process.limit = std::chrono::seconds(60);
  restarted.module.restart_frames = 20;

  const auto found =
      compare_packages(plan, {package_of({module}), package_of({dead}), package_of({restarted})}, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  ASSERT_EQ(found->results.size(), 4u);
  const auto& [none, ended, crashed, whole] =
      std::tie(found->results[0], found->results[1], found->results[2], found->results[3]);
  ASSERT_TRUE(ended.error && crashed.error);
  EXPECT_EQ(ended.error->code, ErrorCode::disconnected);
  EXPECT_GT(ended.trials.size(), 0u);
  EXPECT_LT(ended.trials.size(), none.trials.size());
  EXPECT_EQ(crashed.error->code, ErrorCode::disconnected);
  EXPECT_THAT(crashed.error_lines, ::testing::Contains("the licence has expired"));
  EXPECT_FALSE(whole.error);
  ASSERT_EQ(whole.trials.size(), none.trials.size());
  for (std::size_t i = 0; i < none.trials.size(); ++i) EXPECT_EQ(whole.trials[i].scores, none.trials[i].scores);
  EXPECT_THAT(render_html(enhancement_page(plan, {}, *found)), HasSubstr("the module ended"));
  EXPECT_EQ(side_by_side(*found).rows, 240);
}

TEST(Enhancement, RefusesPlansThatShowEachPackageOtherFrames) {
  const auto found = compare_packages(small_plan("16.9", 2, "[schedule]\nkind = \"adaptive\"\n"), {}, {}, {});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::invalid_input);
}

/// Twelve presentations of six sizes at 2 K, with scores.
std::vector<Trial> scored_trials() {
  std::vector<Trial> trials;
  for (int presentation = 0; presentation < 12; ++presentation) {
    for (int size = 1; size <= 6; ++size) {
      Trial trial;
      trial.presentation = presentation;
      trial.set_delta_t_k = 2;
      trial.size_mrad = size;
      trial.answer = (presentation * 7 + size * 3) % 8 < size + 1 ? Apex::up : Apex::down;
      trial.scores = {1, 0.5, 0.25, size + 0.1 * presentation};
      trials.push_back(trial);
    }
  }
  return trials;
}

TEST(PairedRatios, OfTheSameTrialsAreOneWithoutWidth) {
  const std::vector<Trial> trials = scored_trials();
  auto better = trials;
  for (auto& trial : better) trial.size_mrad /= 1.25;

  const auto same = paired_ratios(trials, trials, {}), ratio = paired_ratios(better, trials, {});

  ASSERT_TRUE(same.size() == 1 && same[0].ratio && same[0].ci95.low);
  EXPECT_EQ(*same[0].ratio, 1);
  EXPECT_EQ(*same[0].ci95.high - *same[0].ci95.low, 0);
  // Sizes in the same proportion at every answer: the ratio is exact and so is every group's.
  EXPECT_NEAR(ratio[0].ratio.value(), 1.25, 1e-6);
  EXPECT_NEAR(ratio[0].ci95.low.value(), 1.25, 1e-4);
}

TEST(PairedRatios, OfEqualAnswersToOtherPicturesHaveAWidth) {
  const std::vector<Trial> without = scored_trials();
  auto with = without;
  for (Trial& trial : with) trial.scores[0] += 1e-6;

  const PairedAnswers answers = paired_answers(with, without, 2);
  const auto ratios = paired_ratios(with, without, {});

  EXPECT_EQ(answers.count, 72u);
  EXPECT_EQ(answers.differing, 0u);
  EXPECT_FALSE(answers.identical);
  EXPECT_TRUE(paired_answers(without, without, 2).identical);
  ASSERT_TRUE(ratios.size() == 1 && ratios[0].ratio && ratios[0].ci95.low && ratios[0].ci95.high);
  EXPECT_EQ(*ratios[0].ratio, 1);
  // 3.6 answers of 72 may differ unseen; a change of ln S75 by 1 changes about half of the answers.
  EXPECT_GT(std::log(*ratios[0].ci95.high), 0.04);
  EXPECT_LT(std::log(*ratios[0].ci95.high), 0.4);
  EXPECT_NEAR(std::log(*ratios[0].ci95.low), -std::log(*ratios[0].ci95.high), 1e-12);
}

TEST(PairedRatios, HoldASmallRatioThatFewAnswersShow) {
  // All answers come from common random numbers: of 480 answers none, one or a few differ.
  for (const double ratio : {1.002, 1.03}) {
    const auto found = testing::coverage_of({.ratio = ratio, .shared_noise = 1}, 40, 9);

    EXPECT_EQ(found.intervals, 40) << ratio;
    // Of 40 with 95 % fewer than 33 hold it with a probability of 1e-3.
    EXPECT_GE(found.holding, 33) << ratio;
    EXPECT_LT(found.mean_half_width, 0.06) << ratio;
  }
}

TEST(PackageFile, IsRefusedInASentence) {
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& text) {
    folder.write("p.toml", text);
    const auto package = read_package(folder.path() / "p.toml");
    return package ? std::string("taken") : package.error().message;
  };
  EXPECT_THAT(refusal(""), HasSubstr("no [[stage]]"));
  EXPECT_THAT(refusal("[[stage]]\nkind = \"blur\"\n"), HasSubstr("kind"));
  EXPECT_THAT(refusal("[[stage]]\nkind = \"recursive\"\nshare = 0\n"), HasSubstr("share"));
  EXPECT_THAT(refusal("[[stage]]\nkind = \"median\"\nsize = 4\n"), HasSubstr("3 or 5"));
  EXPECT_THAT(refusal("[[stage]]\nkind = \"median\"\nshare = 1\n"), HasSubstr("share"));
  EXPECT_THAT(refusal("[[stage]]\nkind = \"module\"\n"), HasSubstr("command"));
  EXPECT_THAT(refusal("[[stage]]\nkind = \"super-resolution\"\nfactor = 3\nframes = 8\n"), HasSubstr("frames"));
  EXPECT_EQ(refusal("[[stage]]\nkind = \"clahe\"\n[[stage]]\nkind = \"plateau\"\n"), "taken");
  for (const char* name : {"recursive", "sharpen", "plateau", "module", "super-resolution"}) {
    const auto package = read_package(source_file(std::string("docs/examples/packages/") + name + ".toml"));
    EXPECT_TRUE(package) << package.error().message;
  }
}

}  // namespace
}  // namespace todbench
