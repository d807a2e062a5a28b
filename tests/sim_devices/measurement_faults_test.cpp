// The measurement when something goes wrong, and on a bench with a hand only.
#include <gmock/gmock.h>

#include <atomic>
#include <cmath>
#include <condition_variable>
#include <limits>
#include <mutex>

#include "tests/sim_devices/measurement_bench.h"
#include "tod/tod_curve.h"

namespace todbench {
namespace {

/// What a fault does to the frame with this index: hands it on, changes it, or fails.
using Fault = std::function<Result<Frame>(std::uint64_t index, Frame frame)>;

/// A simulated camera whose frames pass through a fault.
class FaultySource final : public FrameSource {
 public:
  FaultySource(std::unique_ptr<FrameSource> camera, Fault fault)
      : camera_(std::move(camera)), fault_(std::move(fault)) {}
  [[nodiscard]] const SourceInfo& info() const override { return info_ ? *info_ : camera_->info(); }
  [[nodiscard]] Result<void> start() override { return camera_->start(); }
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds timeout) override {
    auto frame = camera_->next(timeout);
    if (!frame) return frame;
    return fault_(index_++, std::move(*frame));
  }
  void stop() override { camera_->stop(); }
  [[nodiscard]] Result<std::string> get(const std::string& feature) override { return camera_->get(feature); }
  [[nodiscard]] Result<void> set(const std::string& feature, const std::string& value) override {
    return camera_->set(feature, value);
  }
  [[nodiscard]] Result<void> correct_nonuniformity() override {
    ++corrections;
    if (!takes_commands) return fail(ErrorCode::invalid_input, "there is no such command");
    return {};
  }
  void pretend(SourceInfo info) { info_ = std::move(info); }
  int corrections = 0;
  bool takes_commands = true;

 private:
  std::unique_ptr<FrameSource> camera_;
  Fault fault_;
  std::optional<SourceInfo> info_;
  std::uint64_t index_ = 0;
};

/// One plate, one mounting, two contrasts, a few phases: enough to see what happens.
struct SmallBench : test::SimulatedBench {
  std::shared_ptr<SceneHolder> holder;
  std::shared_ptr<const SensorModel> model;
  SmallBench() {
    plates = {test::two_plates().front()};
    mountings = {Mounting::identity};
    contrasts = {16.9, 1.93};
    phases = 3;
    PlateScene scene;
    scene.plate = plates.front();
    holder = std::make_shared<SceneHolder>(scene);
    model = std::make_shared<const SensorModel>(spec, full_plan(spec, {}, {}), Accuracy::draft(), seed);
  }
  [[nodiscard]] std::unique_ptr<FrameSource> camera() const { return simulated_source(model, holder, "1"); }
  [[nodiscard]] Result<MeasurementResult> run(FrameSource& source, const MeasurementOptions& options,
                                              const MeasurementListener& listener = {},
                                              std::stop_token stop = {}) const {
    const auto target = scene_target(holder, plates);
    return run(source, *target, options, listener, stop);
  }
  [[nodiscard]] Result<MeasurementResult> run(FrameSource& source, Target& target, const MeasurementOptions& options,
                                              const MeasurementListener& listener = {},
                                              std::stop_token stop = {}) const {
    TemplateObserver observer({}, triangle_alternatives());
    ListedSchedule schedule = test::schedule_of(*this);
    return measure(source, target, observer, schedule, options, listener, stop);
  }
};

TEST(MeasurementFaults, BadFramesAreCountedByReasonAndNeverMeasured) {
  const SmallBench bench;
  MeasurementOptions options = test::options_of(bench);
  options.max_rejected_share = 0.5;
  const auto last = std::make_shared<Frame>();
  FaultySource source(bench.camera(), [last](std::uint64_t index, Frame frame) -> Result<Frame> {
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
  FaultySource source(bench.camera(), [](std::uint64_t index, Frame frame) -> Result<Frame> {
    if (index > 20 && index % 2 == 0) frame.status = FrameStatus::incomplete;
    return frame;
  });

  const auto result = bench.run(source, test::options_of(bench));

  ASSERT_FALSE(result.has_value() && !result->ended_by.has_value());
  const Error error = result ? *result->ended_by : result.error();
  EXPECT_EQ(error.code, ErrorCode::integrity);
  EXPECT_THAT(error.message, testing::HasSubstr("incomplete"));
}

TEST(MeasurementFaults, ALostCameraEndsTheRunAndKeepsItsTrials) {
  const SmallBench bench;
  std::size_t heard = 0;
  FaultySource source(bench.camera(), [](std::uint64_t index, Frame frame) -> Result<Frame> {
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
  FaultySource source(bench.camera(), [](std::uint64_t index, Frame frame) -> Result<Frame> {
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
  MeasurementListener listener;
  listener.on_lost = [&](const Error&, std::stop_token) -> Result<void> {
    if (++reconnections > 10) return fail(ErrorCode::internal, "connected again and again");
    return {};
  };

  const auto result = bench.run(*camera, target, test::options_of(bench), listener);

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
  FaultySource source(bench.camera(), [](std::uint64_t, Frame frame) -> Result<Frame> { return frame; });
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

/// A hand: goes near where it was asked to, never says where it is, and moves the plate by up to two pixels each time.
class HandTarget final : public Target {
 public:
  HandTarget(std::shared_ptr<SceneHolder> scene, std::vector<TargetPlate> plates)
      : target_(scene_target(std::move(scene), std::move(plates))) {
    capabilities_ = target_->capabilities();
    capabilities_.sets_shift = false;
  }
  [[nodiscard]] const TargetCapabilities& capabilities() const override { return capabilities_; }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    TargetState shown = state;
    shown.shift_mm = {5.2 * (random_.uniform(2 * count_) - 0.5), 5.2 * (random_.uniform(2 * count_ + 1) - 0.5)};
    ++count_;
    auto presented = target_->present(shown, stop);
    if (presented) presented->state = state;
    return presented;
  }

 private:
  std::unique_ptr<Target> target_;
  TargetCapabilities capabilities_;
  RandomStream random_{1, "hand"};
  std::uint64_t count_ = 0;
};

TEST(MeasurementByHand, FindsThePhaseOfEveryPresentationInThePicture) {
  SmallBench bench;
  bench.contrasts = {16.9, 0.23};
  bench.phases = 12;
  HandTarget hand(bench.holder, bench.plates);
  std::vector<cv::Point2d> shown;  // true phase of the first triangle at each presentation
  std::vector<cv::Point2d> found;
  const auto camera = bench.camera();
  MeasurementListener listener;
  listener.on_trial = [&](const Trial& trial) {
    if (trial.triangle != "row 1, triangle 1") return;
    const auto scene = bench.holder->scene();
    const cv::Point2d px =
        scene_pixel(*scene, scene->plate.triangles.front().position_mm, bench.spec.ifov_mrad(), {320, 240});
    shown.emplace_back(px.x - std::floor(px.x) - 0.5, px.y - std::floor(px.y) - 0.5);
    found.emplace_back(trial.phase_x_px, trial.phase_y_px);
  };

  const auto result = bench.run(*camera, hand, test::options_of(bench), listener);

  ASSERT_TRUE(result.has_value()) << result.error().message;
  ASSERT_FALSE(result->ended_by.has_value()) << result->ended_by->message;
  ASSERT_EQ(shown.size(), 24u);
  double squares = 0;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    // Phases wrap at half a pixel.
    const cv::Point2d d = shown[i] - found[i];
    squares += std::pow(d.x - std::round(d.x), 2) + std::pow(d.y - std::round(d.y), 2);
  }
  // 0.017 px per axis at 0.23 K with 16 frames (error of the shift measurement), with room for 24 presentations.
  EXPECT_LT(std::sqrt(squares / (2.0 * static_cast<double>(shown.size()))), 0.03);
}

TEST(MeasurementNuc, CorrectsBeforeTheRunAndKeepsFramesOutUntilItHasPassed) {
  const SmallBench bench;
  MeasurementOptions options = test::options_of(bench);
  options.nuc_interval_s = 3600;
  options.nuc_wait_s = 0.5;
  FaultySource source(bench.camera(), [](std::uint64_t, Frame frame) -> Result<Frame> { return frame; });

  const auto result = bench.run(source, options);

  ASSERT_TRUE(result.has_value()) << result.error().message;
  EXPECT_EQ(source.corrections, 1);
  EXPECT_GT(result->frames_rejected.at("nonuniformity_correction"), 0u);
  for (const auto& trial : result->trials) EXPECT_GE(trial.since_nuc_s, 0.5);
}

TEST(MeasurementNuc, IsLeftToACameraThatTakesNoCommandAndTellsOfItsCorrections) {
  const SmallBench bench;
  MeasurementOptions options = test::options_of(bench);
  options.nuc_interval_s = 60;
  options.nuc_wait_s = 0;  // the frames of the correction itself are what counts here
  FaultySource source(bench.camera(), [](std::uint64_t index, Frame frame) -> Result<Frame> {
    frame.correction = index % 40 < 3 ? CorrectionState::running : CorrectionState::idle;
    return frame;
  });
  source.takes_commands = false;

  const auto result = bench.run(source, options);

  ASSERT_TRUE(result.has_value()) << result.error().message;
  EXPECT_FALSE(result->ended_by.has_value());
  EXPECT_EQ(source.corrections, 1);
  EXPECT_THAT(result->notes, testing::Contains(testing::HasSubstr("there is no such command")));
  EXPECT_GT(result->frames_rejected.at("nonuniformity_correction"), 3u);
}

TEST(MeasurementNuc, IsRefusedWhereTheCameraTakesNoCommandAndTellsNothing) {
  const SmallBench bench;
  MeasurementOptions options = test::options_of(bench);
  options.nuc_interval_s = 60;
  FaultySource source(bench.camera(), [](std::uint64_t, Frame frame) -> Result<Frame> { return frame; });
  source.takes_commands = false;

  const auto result = bench.run(source, options);

  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code, ErrorCode::invalid_input);
}

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
  FaultySource source(bench.camera(), [&](std::uint64_t, Frame frame) -> Result<Frame> {
    ++frames;
    frames.notify_all();
    return frame;
  });
  SlowTarget target(scene_target(bench.holder, bench.plates), frames);
  MeasurementOptions options = test::options_of(bench);
  options.frames_while_presenting = FramesMeanwhile::take;
  std::vector<std::int64_t> asked;
  MeasurementListener listener;
  listener.asked_while_presenting = [&](std::int64_t calls) {
    asked.push_back(calls);
    return calls;
  };

  const auto result = bench.run(source, target, options, listener);

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
  FaultySource source(bench.camera(), [&](std::uint64_t, Frame frame) -> Result<Frame> {
    const std::uint64_t now = ++frames;
    frames.notify_all();
    if (now == last) return fail(ErrorCode::disconnected, "unplugged");
    return frame;
  });
  SlowTarget target(scene_target(bench.holder, bench.plates), frames, last);
  MeasurementOptions options = test::options_of(bench);
  options.frames_while_presenting = FramesMeanwhile::take;
  MeasurementListener listener;
  int losses = 0;
  listener.on_lost = [&](const Error&, std::stop_token) -> Result<void> {
    ++losses;
    return {};
  };

  const auto result = bench.run(source, target, options, listener);

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
  FaultySource source(bench.camera(), [&](std::uint64_t, Frame frame) -> Result<Frame> {
    if (target.settling) return fail(ErrorCode::disconnected, "unplugged");
    return frame;
  });
  MeasurementOptions options = test::options_of(bench);
  options.frames_while_presenting = FramesMeanwhile::take;
  MeasurementListener listener;
  std::vector<std::string> losses;
  listener.on_lost = [&](const Error& why, std::stop_token) -> Result<void> {
    losses.push_back(why.message);
    return {};
  };

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
  FaultySource source(bench.camera(), [&](std::uint64_t, Frame frame) -> Result<Frame> {
    if (target.settling) stop.request_stop();
    return frame;
  });
  MeasurementOptions options = test::options_of(bench);
  options.frames_while_presenting = FramesMeanwhile::take;

  const auto result = bench.run(source, target, options, {}, stop.get_token());

  ASSERT_TRUE(result.has_value()) << result.error().message;
  ASSERT_TRUE(result->ended_by.has_value());
  EXPECT_EQ(result->ended_by->code, ErrorCode::interrupted);
  EXPECT_EQ(result->trials.size(), 2u * 20u);
}

}  // namespace
}  // namespace todbench
