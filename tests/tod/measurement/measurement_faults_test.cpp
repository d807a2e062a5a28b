// SPDX-License-Identifier: GPL-3.0-or-later
// The measurement when something goes wrong.
#include <gmock/gmock.h>

#include "tests/tod/measurement/faulty_bench.h"

namespace todbench {
namespace {

using test::DisturbedSource;
using test::SmallBench;

TEST(MeasurementFaults, BadFramesAreCountedByReasonAndNeverMeasured) {
  const SmallBench bench;
  MeasurementOptions options = test::options_of(bench);
  options.max_rejected_share = 0.5;
  const auto last = std::make_shared<Frame>();
  DisturbedSource source(bench.camera(), [last](std::uint64_t index, Frame frame) -> Result<Frame> {
    if (index % 10 == 3) frame.status = FrameStatus::incomplete;
    if (index % 10 == 6) frame.counts = cv::Mat1w(frame.counts.size(), std::uint16_t{0});
    if (index % 10 == 8) frame = *last;
    *last = frame;
    return frame;
  });

  const auto result = bench.run(source, options);

  ASSERT_TRUE(result.has_value()) << result.error().message;
  EXPECT_FALSE(result->ended_by.has_value());
  EXPECT_EQ(result->trials.size(), 2u * 3u * 20u);
  EXPECT_GT(result->frames_rejected.at("incomplete"), 5u);
  EXPECT_GT(result->frames_rejected.at("saturated"), 5u);
  EXPECT_GT(result->frames_rejected.at("repeated"), 5u);
  for (const auto& trial : result->trials) {
    EXPECT_NE(trial.frame % 10, 3u);
    EXPECT_NE(trial.frame % 10, 6u);
  }
}

TEST(MeasurementFaults, TooManyBadFramesEndTheRunWithIntegrity) {
  const SmallBench bench;
  DisturbedSource source(bench.camera(), [](std::uint64_t index, Frame frame) -> Result<Frame> {
    if (index > 20 && index % 2 == 0) frame.status = FrameStatus::incomplete;
    return frame;
  });

  const auto result = bench.run(source, test::options_of(bench));

  ASSERT_FALSE(result.has_value() && !result->ended_by.has_value());
  const Error error = result ? *result->ended_by : result.error();
  EXPECT_EQ(error.code, ErrorCode::integrity);
  EXPECT_THAT(error.message, testing::HasSubstr("incomplete"));
}

/// Every tenth frame of a run comes after ten that are missing.
Result<MeasurementResult> run_with_gaps(Numbering numbering) {
  const SmallBench bench;
  DisturbedSource source(bench.camera(), [&](std::uint64_t index, Frame frame) -> Result<Frame> {
    frame.sequence += index / 10 * 10;
    if (index % 10 == 0 && index > 0) frame.numbering = numbering;
    return frame;
  });
  return bench.run(source, test::options_of(bench));
}

TEST(MeasurementFaults, FramesThatNobodyReadDoNotEndTheRun) {
  const auto lost = run_with_gaps(Numbering::counted);
  const auto unread = run_with_gaps(Numbering::unread);

  ASSERT_TRUE(unread.has_value()) << unread.error().message;
  EXPECT_FALSE(unread->ended_by.has_value());
  EXPECT_GE(unread->frames_lost, 10u);
  EXPECT_THAT(unread->notes, testing::Contains(testing::HasSubstr("found its buffers full")));
  ASSERT_FALSE(lost.has_value() && !lost->ended_by.has_value());
  EXPECT_EQ((lost ? *lost->ended_by : lost.error()).code, ErrorCode::integrity);
}

TEST(MeasurementFaults, ALostCameraEndsTheRunAndKeepsItsTrials) {
  const SmallBench bench;
  std::size_t heard = 0;
  DisturbedSource source(bench.camera(), [](std::uint64_t index, Frame frame) -> Result<Frame> {
    if (index > 50) return fail(ErrorCode::disconnected, "the camera is gone");
    return frame;
  });

  const auto result = bench.run(source, test::options_of(bench),
                                {.on_trial = [&](const Trial&) { ++heard; }, .on_progress = {}, .on_note = {}});

  ASSERT_TRUE(result.has_value()) << result.error().message;
  ASSERT_TRUE(result->ended_by.has_value());
  EXPECT_EQ(result->ended_by->code, ErrorCode::disconnected);
  EXPECT_EQ(result->trials.size(), heard);
  EXPECT_EQ(heard % 20, 0u);
  EXPECT_GT(heard, 0u);
}

TEST(MeasurementFaults, ASilentCameraIsALostCamera) {
  const SmallBench bench;
  DisturbedSource source(bench.camera(), [](std::uint64_t index, Frame frame) -> Result<Frame> {
    if (index > 50) return fail(ErrorCode::timeout, "no frame");
    return frame;
  });

  const auto result = bench.run(source, test::options_of(bench));

  ASSERT_TRUE(result.has_value());
  ASSERT_TRUE(result->ended_by.has_value());
  EXPECT_EQ(result->ended_by->code, ErrorCode::disconnected);
}

/// Its instruments vanish after some presentations.
class VanishingTarget final : public Target {
 public:
  VanishingTarget(std::unique_ptr<Target> target, int presentations)
      : target_(std::move(target)), presentations_(presentations) {}
  [[nodiscard]] const TargetCapabilities& capabilities() const override { return target_->capabilities(); }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    if (presentations_-- <= 0) return fail(ErrorCode::disconnected, "the black body is gone");
    return target_->present(state, stop);
  }

 private:
  std::unique_ptr<Target> target_;
  int presentations_;
};

TEST(MeasurementFaults, ALostTargetIsNotTakenForALostCamera) {
  const SmallBench bench;
  const auto camera = bench.camera();
  VanishingTarget target(scene_target(bench.holder, bench.plates), 3);
  int reconnections = 0;
  bench.host->bring_back = [&](std::stop_token) -> Result<void> {
    if (++reconnections > 10) return fail(ErrorCode::internal, "connected again and again");
    return {};
  };

  const auto result = bench.run(*camera, target, test::options_of(bench));

  ASSERT_TRUE(result.has_value()) << result.error().message;
  ASSERT_TRUE(result->ended_by.has_value());
  EXPECT_EQ(result->ended_by->code, ErrorCode::disconnected);
  EXPECT_THAT(result->ended_by->message, testing::HasSubstr("the black body is gone"));
  EXPECT_EQ(result->trials.size(), 3u * 20u);
  EXPECT_EQ(reconnections, 0);
}

TEST(MeasurementFaults, AStopRequestEndsTheRunWithItsTrials) {
  const SmallBench bench;
  std::stop_source stop;
  const auto camera = bench.camera();
  MeasurementListener listener;
  listener.on_progress = [&](std::size_t done, std::size_t) {
    if (done == 2) stop.request_stop();
  };

  const auto result = bench.run(*camera, test::options_of(bench), listener, stop.get_token());

  ASSERT_TRUE(result.has_value()) << result.error().message;
  ASSERT_TRUE(result->ended_by.has_value());
  EXPECT_EQ(result->ended_by->code, ErrorCode::interrupted);
  EXPECT_EQ(result->trials.size(), 2u * 20u);
}

TEST(MeasurementFaults, AnUncalibratedCameraIsRefused) {
  const SmallBench bench;
  DisturbedSource source(bench.camera(), [](std::uint64_t, Frame frame) -> Result<Frame> { return frame; });
  SourceInfo info = bench.camera()->info();
  info.scale = RadiometricScale();
  source.pretend(info);

  const auto result = bench.run(source, test::options_of(bench));

  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code, ErrorCode::calibration);
}

TEST(MeasurementFaults, ADistanceThatContradictsThePictureIsRefused) {
  const SmallBench bench;
  MeasurementOptions options = test::options_of(bench);
  options.distance_m = 2.1;
  const auto camera = bench.camera();

  const auto result = bench.run(*camera, options);

  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code, ErrorCode::calibration);
  EXPECT_THAT(result.error().message, testing::HasSubstr("scale"));
}

TEST(MeasurementFaults, SizesWhoseWindowsTouchAreRefusedByName) {
  SmallBench bench;
  bench.plates.front().triangles[1].position_mm = bench.plates.front().triangles[0].position_mm + cv::Point2d(26, 0);
  const auto camera = bench.camera();

  const auto result = bench.run(*camera, test::options_of(bench));

  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(result.error().message, testing::HasSubstr("row 1, triangle 1"));
}

/// Says one polarity, shows the other.
class InvertedTarget final : public Target {
 public:
  explicit InvertedTarget(std::unique_ptr<Target> target) : target_(std::move(target)) {}
  [[nodiscard]] const TargetCapabilities& capabilities() const override { return target_->capabilities(); }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    TargetState shown = state;
    shown.delta_t_k = -state.delta_t_k;
    return target_->present(shown, stop);
  }

 private:
  std::unique_ptr<Target> target_;
};

TEST(MeasurementFaults, TheWrongPolarityIsRefused) {
  const SmallBench bench;
  InvertedTarget target(scene_target(bench.holder, bench.plates));
  const auto camera = bench.camera();

  const auto result = bench.run(*camera, target, test::options_of(bench));

  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code, ErrorCode::calibration);
  EXPECT_THAT(result.error().message, testing::HasSubstr("polarity"));
}

TEST(MeasurementFaults, ACameraThatSendsEachExposureTwiceIsMeasuredByItsExposures) {
  const SmallBench bench;
  cv::Mat1w last;
  DisturbedSource source(bench.camera(), [&](std::uint64_t index, Frame frame) -> Result<Frame> {
    if (index % 2 == 1) frame.counts = last;
    last = frame.counts;
    return frame;
  });

  const auto result = bench.run(source, test::options_of(bench));

  ASSERT_TRUE(result.has_value()) << result.error().message;
  EXPECT_FALSE(result->ended_by.has_value());
  EXPECT_THAT(result->notes, testing::Contains(testing::HasSubstr("sends each exposure 2 times")));
}

}  // namespace
}  // namespace todbench
