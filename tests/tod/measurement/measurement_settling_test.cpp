// SPDX-License-Identifier: GPL-3.0-or-later
// What becomes of the camera while the target settles: a second thread takes its frames.
#include <gmock/gmock.h>

#include <atomic>
#include <condition_variable>
#include <limits>
#include <mutex>
#include <string>
#include <vector>

#include "tests/tod/measurement/faulty_bench.h"

namespace todbench {
namespace {

using test::DisturbedSource;
using test::SmallBench;

/// Settles only when the camera has sent so many frames more, longer than any queue, or when it has sent its last.
class SlowTarget final : public Target {
 public:
  SlowTarget(std::unique_ptr<Target> target, const std::atomic<std::uint64_t>& frames,
             std::uint64_t last = std::numeric_limits<std::uint64_t>::max())
      : target_(std::move(target)), frames_(frames), last_(last) {}
  [[nodiscard]] const TargetCapabilities& capabilities() const override { return target_->capabilities(); }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    const std::uint64_t enough = frames_ + 100;
    for (std::uint64_t now = frames_; now < enough && now != last_; now = frames_) frames_.wait(now);
    return target_->present(state, stop);
  }

 private:
  std::unique_ptr<Target> target_;
  const std::atomic<std::uint64_t>& frames_;
  std::uint64_t last_;
};

TEST(MeasurementFaults, NoFrameIsLeftToAQueueWhileTheTargetSettles) {
  SmallBench bench;
  bench.contrasts = {16.9};
  std::atomic<std::uint64_t> frames = 0;
  DisturbedSource source(bench.camera(), [&](std::uint64_t, Frame frame) -> Result<Frame> {
    ++frames;
    frames.notify_all();
    return frame;
  });
  SlowTarget target(scene_target(bench.holder, bench.plates), frames);
  const MeasurementOptions options = test::options_of(bench);
  bench.host->meanwhile = FramesWhilePresenting::take;
  std::vector<std::int64_t> asked;
  bench.host->asked = [&](std::int64_t calls) {
    asked.push_back(calls);
    return calls;
  };

  const auto result = bench.run(source, target, options);

  ASSERT_TRUE(result.has_value()) << result.error().message;
  EXPECT_FALSE(result->ended_by.has_value());
  EXPECT_EQ(result->trials.size(), 3u * 20u);
  EXPECT_EQ(result->frames_lost, 0u);
  EXPECT_THAT(asked, testing::SizeIs(3));
  EXPECT_THAT(asked, testing::Each(testing::Ge(100)));
}

TEST(MeasurementFaults, ACameraThatIsLostWhileTheTargetSettlesIsALostCamera) {
  SmallBench bench;
  constexpr std::uint64_t last = 250;
  std::atomic<std::uint64_t> frames = 0;
  DisturbedSource source(bench.camera(), [&](std::uint64_t, Frame frame) -> Result<Frame> {
    const std::uint64_t now = ++frames;
    frames.notify_all();
    if (now == last) return fail(ErrorCode::disconnected, "unplugged");
    return frame;
  });
  SlowTarget target(scene_target(bench.holder, bench.plates), frames, last);
  const MeasurementOptions options = test::options_of(bench);
  bench.host->meanwhile = FramesWhilePresenting::take;
  int losses = 0;
  bench.host->bring_back = [&](std::stop_token) -> Result<void> {
    ++losses;
    return {};
  };

  const auto result = bench.run(source, target, options);

  ASSERT_TRUE(result.has_value()) << result.error().message;
  EXPECT_FALSE(result->ended_by.has_value());
  EXPECT_EQ(losses, 1);
  EXPECT_THAT(result->interruptions, testing::SizeIs(1));
  EXPECT_EQ(result->trials.size(), 2u * 3u * 20u);
}

/// Does not settle in one of its presentations until it is told to stop.
class EndlessTarget final : public Target {
 public:
  EndlessTarget(std::unique_ptr<Target> target, int presentation)
      : target_(std::move(target)), presentation_(presentation) {}
  [[nodiscard]] const TargetCapabilities& capabilities() const override { return target_->capabilities(); }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    if (presentation_-- != 0) return target_->present(state, stop);
    settling = true;
    std::mutex mutex;
    std::unique_lock lock(mutex);
    std::condition_variable_any never;
    never.wait(lock, stop, [] { return false; });
    settling = false;
    return fail(ErrorCode::interrupted, "stopped while the black body was settling");
  }
  std::atomic<bool> settling = false;

 private:
  std::unique_ptr<Target> target_;
  int presentation_;
};

TEST(MeasurementFaults, ACameraThatIsLostWhileTheTargetSettlesEndsTheWaitForTheTarget) {
  SmallBench bench;
  EndlessTarget target(scene_target(bench.holder, bench.plates), 2);
  DisturbedSource source(bench.camera(), [&](std::uint64_t, Frame frame) -> Result<Frame> {
    if (target.settling) return fail(ErrorCode::disconnected, "unplugged");
    return frame;
  });
  const MeasurementOptions options = test::options_of(bench);
  bench.host->meanwhile = FramesWhilePresenting::take;
  MeasurementListener listener;
  std::vector<std::string> losses;
  listener.on_lost = [&](const Error& why) { losses.push_back(why.message); };
  bench.host->bring_back = [](std::stop_token) -> Result<void> { return {}; };

  const auto result = bench.run(source, target, options, listener);

  ASSERT_TRUE(result.has_value()) << result.error().message;
  EXPECT_FALSE(result->ended_by.has_value());
  EXPECT_THAT(losses, testing::ElementsAre("unplugged"));
  ASSERT_THAT(result->interruptions, testing::SizeIs(1));
  EXPECT_EQ(result->interruptions.front().presentation, 2);
  EXPECT_EQ(result->trials.size(), 2u * 3u * 20u);
}

TEST(MeasurementFaults, AStopRequestWhileTheTargetSettlesIsNoLossOfTheCamera) {
  SmallBench bench;
  EndlessTarget target(scene_target(bench.holder, bench.plates), 2);
  std::stop_source stop;
  DisturbedSource source(bench.camera(), [&](std::uint64_t, Frame frame) -> Result<Frame> {
    if (target.settling) stop.request_stop();
    return frame;
  });
  const MeasurementOptions options = test::options_of(bench);
  bench.host->meanwhile = FramesWhilePresenting::take;

  const auto result = bench.run(source, target, options, {}, stop.get_token());

  ASSERT_TRUE(result.has_value()) << result.error().message;
  ASSERT_TRUE(result->ended_by.has_value());
  EXPECT_EQ(result->ended_by->code, ErrorCode::interrupted);
  EXPECT_EQ(result->trials.size(), 2u * 20u);
}

}  // namespace
}  // namespace todbench
