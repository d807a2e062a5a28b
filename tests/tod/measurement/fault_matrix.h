// SPDX-License-Identifier: GPL-3.0-or-later
// Every reason of the integrity gate, injected at 0.1, 1 and 5 % into a measurement: the answers are those of an
// undisturbed run over the same exposures, bit for bit, the counts are right and no trial is missing.
#pragma once

#include <gmock/gmock.h>

#include "tests/support/parameter_names.h"
#include "tests/tod/measurement/injected_faults.h"
#include "tests/tod/measurement/measurement_bench.h"

namespace todbench::test {

struct FaultRun {
  MeasurementResult result;
  std::shared_ptr<FaultBook> book = std::make_shared<FaultBook>();
};

/// One plate at two contrasts with enough discarded frames that a rate of 0.1 % means several faults.
class FaultMatrix : public testing::Test {
 protected:
  FaultMatrix() {
    bench_.plates = {two_plates().front()};
    bench_.mountings = {Mounting::identity};
    bench_.contrasts = {16.9, 1.93};
    bench_.phases = 40;
    model_ = std::make_shared<const SensorModel>(bench_.spec, full_plan(bench_.spec, {}, {}), Accuracy::draft(),
                                                 bench_.seed);
  }

  [[nodiscard]] MeasurementOptions options() const {
    MeasurementOptions options = options_of(bench_);
    options.frames_after_change = 12;
    options.nuc_wait_s = 0;
    options.max_rejected_share = 0.2;
    options.answers = answers_;
    options.frames_per_presentation = frames_;
    return options;
  }

  void grade_answers(int frames) {
    answers_ = AnswerKind::graded;
    frames_ = frames;
  }

  [[nodiscard]] FaultRun disturbed(const FaultPlan& plan) const {
    FaultRun run;
    run.result = measured([&](std::unique_ptr<FrameSource> camera) -> std::unique_ptr<FrameSource> {
      return std::make_unique<FaultySource>(std::move(camera), plan, run.book);
    });
    return run;
  }

  [[nodiscard]] FaultRun undisturbed(const std::set<std::uint64_t>& without) const {
    FaultRun run;
    run.result = measured([&](std::unique_ptr<FrameSource> camera) -> std::unique_ptr<FrameSource> {
      return std::make_unique<SkippingSource>(std::move(camera), without, run.book);
    });
    return run;
  }

  /// Runs with the fault and without, and compares everything.
  void expect_same_answers(const FaultPlan& plan) const {
    const FaultRun with = disturbed(plan);
    const FaultRun without = undisturbed(with.book->spoiled);

    ASSERT_FALSE(with.book->injected.empty());
    EXPECT_EQ(with.result.trials.size(), 2u * 40u * 20u);
    EXPECT_FALSE(with.result.ended_by.has_value());
    for (const auto& [reason, count] : with.book->injected) {
      const auto counted = with.result.frames_rejected.find(std::string(to_string(reason)));
      ASSERT_NE(counted, with.result.frames_rejected.end()) << to_string(reason);
      EXPECT_EQ(counted->second, count) << to_string(reason);
    }
    EXPECT_EQ(with.result.frames_rejected.size(), with.book->injected.size());
    EXPECT_EQ(with.result.frames_lost, with.book->lost);
    EXPECT_TRUE(without.result.frames_rejected.empty());
    expect_equal_trials(with, without);
  }

  static void expect_equal_trials(const FaultRun& with, const FaultRun& without) {
    ASSERT_EQ(with.result.trials.size(), without.result.trials.size());
    for (std::size_t i = 0; i < with.result.trials.size(); ++i) {
      const Trial &a = with.result.trials[i], &b = without.result.trials[i];
      ASSERT_EQ(with.book->exposure_of.at(a.frame), without.book->exposure_of.at(b.frame)) << "trial " << i;
      ASSERT_EQ(a.presentation, b.presentation) << "trial " << i;
      ASSERT_EQ(a.triangle, b.triangle) << "trial " << i;
      ASSERT_EQ(a.answer, b.answer) << "trial " << i;
      ASSERT_EQ(a.scores, b.scores) << "trial " << i;
      ASSERT_EQ(a.probability_correct, b.probability_correct) << "trial " << i;
      ASSERT_EQ(a.frames, b.frames) << "trial " << i;
      ASSERT_EQ(a.delta_t_k, b.delta_t_k) << "trial " << i;
      ASSERT_FALSE(with.book->spoiled.contains(with.book->exposure_of.at(a.frame))) << "trial " << i;
    }
  }

 private:
  template <typename Decorate>
  [[nodiscard]] MeasurementResult measured(Decorate decorate) const {
    PlateScene scene;
    scene.plate = bench_.plates.front();
    const auto holder = std::make_shared<SceneHolder>(scene);
    const auto source = decorate(simulated_source(model_, holder, "1"));
    const auto target = scene_target(holder, bench_.plates);
    TemplateObserver observer({}, triangle_alternatives());
    ListedSchedule schedule = schedule_of(bench_);
    auto result = measure(*source, *target, observer, schedule, options(), *bench_.host, {}, {});
    EXPECT_TRUE(result.has_value()) << (result ? "" : result.error().message);
    return result ? std::move(*result) : MeasurementResult();
  }

  SimulatedBench bench_;
  std::shared_ptr<const SensorModel> model_;
  AnswerKind answers_ = AnswerKind::binary;
  int frames_ = 1;
};

}  // namespace todbench::test
