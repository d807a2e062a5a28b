// SPDX-License-Identifier: GPL-3.0-or-later
// Who commands a measurement, and what it keeps of what the target said.
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "tests/tod/measurement/faulty_bench.h"

namespace todbench {
namespace {

using test::SmallBench;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

TEST(RunController, IsAskedBeforeEveryPresentationAndAgainWhileTheRunRests) {
  const SmallBench bench;
  MeasurementOptions options = test::options_of(bench);
  options.free_running = false;
  const auto camera = bench.camera();
  std::vector<std::size_t> trials_when_asked;
  std::size_t trials = 0;
  MeasurementListener listener;
  listener.on_trial = [&](const Trial&) { ++trials; };
  bench.host->rest = [&]() -> Result<bool> {
    trials_when_asked.push_back(trials);
    return trials_when_asked.size() == 2 || trials_when_asked.size() == 3;  // twice before the second presentation
  };

  const auto result = bench.run(*camera, options, listener);

  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->trials.size(), 2u * 3u * 20u);
  EXPECT_THAT(trials_when_asked, ElementsAre(0, 20, 20, 20, 40, 60, 80, 100));
}

TEST(RunController, IsToldWhatEveryLookAtTheClockIsFor) {
  SmallBench bench;
  bench.contrasts = {16.9};
  bench.phases = 1;
  MeasurementOptions options = test::options_of(bench);
  options.nuc_interval_s = 3600;
  options.nuc_wait_s = 0;
  const auto camera = bench.camera();
  std::vector<std::string> moments;
  bench.host->clock = [&](Moment why) {
    moments.emplace_back(to_string(why));
    return monotonic_ns();
  };

  const auto result = bench.run(*camera, options);

  ASSERT_TRUE(result) << result.error().message;
  EXPECT_THAT(moments, ElementsAre("correction_due", "corrected", "correction_due", "scene_changed"));
}

TEST(RunController, EndsTheRunWithWhatItCannotAnswer) {
  const SmallBench bench;
  const auto camera = bench.camera();
  int asked = 0;
  bench.host->rest = [&]() -> Result<bool> {
    if (++asked == 3) return fail(ErrorCode::invalid_input, "another question than that of then");
    return false;
  };

  const auto result = bench.run(*camera, test::options_of(bench));

  ASSERT_TRUE(result) << result.error().message;
  ASSERT_TRUE(result->ended_by);
  EXPECT_EQ(result->ended_by->code, ErrorCode::invalid_input);
  EXPECT_EQ(result->ended_by->message, "another question than that of then");
  EXPECT_EQ(result->trials.size(), 2u * 20u);
}

TEST(RunController, ThatCannotSayHowOftenFramesWereAskedForEndsTheRun) {
  const SmallBench bench;
  const auto camera = bench.camera();
  bench.host->meanwhile = FramesWhilePresenting::repeat;
  bench.host->asked = [](std::int64_t) -> Result<std::int64_t> { return fail(ErrorCode::invalid_input, "no answer"); };

  const auto result = bench.run(*camera, test::options_of(bench));

  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().message, "no answer");
}

/// Shows what it is told and says a little less.
class OffsetTarget final : public Target {
 public:
  OffsetTarget(std::unique_ptr<Target> target, double offset_k) : target_(std::move(target)), offset_k_(offset_k) {}
  [[nodiscard]] const TargetCapabilities& capabilities() const override { return target_->capabilities(); }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    auto said = target_->present(state, stop);
    if (said) said->state.delta_t_k += offset_k_;
    return said;
  }

 private:
  std::unique_ptr<Target> target_;
  double offset_k_;
};

TEST(Presentations, KeepWhatTheTargetSaidBeforeTheTrialsOfEach) {
  const SmallBench bench;
  OffsetTarget target(scene_target(bench.holder, bench.plates), -0.01);
  const auto camera = bench.camera();
  std::vector<Presentation> heard;
  std::size_t trials = 0;
  MeasurementListener listener;
  listener.on_trial = [&](const Trial& trial) {
    ++trials;
    EXPECT_EQ(trial.presentation, heard.back().presentation);
  };
  listener.on_presentation = [&](const Presentation& shown) {
    EXPECT_EQ(trials, heard.size() * 20);
    heard.push_back(shown);
  };

  const auto result = bench.run(*camera, target, test::options_of(bench), listener);

  ASSERT_TRUE(result) << result.error().message;
  ASSERT_THAT(heard, SizeIs(2 * 3));
  EXPECT_EQ(result->presentations, heard);
  for (std::size_t i = 0; i < heard.size(); ++i) {
    EXPECT_EQ(heard[i].presentation, static_cast<std::int64_t>(i));
    EXPECT_EQ(heard[i].said.state.delta_t_k, heard[i].set.delta_t_k - 0.01);
    EXPECT_EQ(heard[i].delta_t_k, result->trials[i * 20].delta_t_k);
    EXPECT_TRUE(heard[i].said.plate_temperature_k);
  }
}

TEST(Presentations, AreKeptAlsoWhenTheCameraCannotMakeAnythingOfThem) {
  SmallBench bench;
  MeasurementOptions options = test::options_of(bench);
  options.registration.max_residual_px = 1e-9;
  const auto camera = bench.camera();
  std::vector<Presentation> heard;
  MeasurementListener listener;
  listener.on_presentation = [&](const Presentation& shown) { heard.push_back(shown); };

  const auto result = bench.run(*camera, options, listener);

  ASSERT_FALSE(result);
  ASSERT_THAT(heard, SizeIs(1));
  EXPECT_FALSE(heard.front().delta_t_k);
}

TEST(Presentations, ThatSayMoreThanTheToleranceAwayAreNotedOncePerContrast) {
  const SmallBench bench;
  OffsetTarget target(scene_target(bench.holder, bench.plates), -0.01);
  const auto camera = bench.camera();
  MeasurementOptions options = test::options_of(bench);
  options.max_readback_deviation_k = 0.009;

  const auto noted = bench.run(*camera, target, options);
  options.max_readback_deviation_k = 0.011;
  const auto quiet = bench.run(*camera, target, options);

  ASSERT_TRUE(noted && quiet);
  EXPECT_THAT(noted->notes, ElementsAre(HasSubstr("the target reports"), HasSubstr("the target reports")));
  EXPECT_THAT(noted->notes.front(), HasSubstr("-0.0100 K, tolerance 0.0090 K"));
  EXPECT_THAT(quiet->notes, ::testing::IsEmpty());
}

}  // namespace
}  // namespace todbench
