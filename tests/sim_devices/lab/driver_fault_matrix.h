// SPDX-License-Identifier: GPL-3.0-or-later
// Every fault of the way from a camera on USB, in a measurement: the answers are those of the simulated camera over the
// exposures that arrived whole, bit for bit, and every other frame is counted by its reason.
#pragma once

#include <gmock/gmock.h>

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/base/rng.h"
#include "acquisition/core/byte_order.h"
#include "tests/support/swapped_bytes.h"
#include "tests/tod/measurement/free_running_camera.h"
#include "tests/tod/measurement/measurement_bench.h"

namespace todbench::test {

/// What goes wrong on the way.
enum class DriverFault {
  lost,       ///< the exposure never arrives
  truncated,  ///< a part of the frame arrives, and the driver or the protocol knows
  shortened,  ///< a part of the frame arrives as if it were all
  frozen,     ///< the picture of the exposure before it arrives once more
  swapped     ///< the bytes of every count are in the other order
};

/// Tells an emulated camera what becomes of its next frame; set before it streams. Called while it exposes.
struct FaultCommands {
  std::function<void()> lose, truncate, shorten;
};

/// An emulated camera and how clients reach it.
struct PluggedCamera {
  std::string id;
  std::shared_ptr<void> device;  ///< unplugged when destroyed
  std::map<std::string, std::string> settings;
  std::unique_ptr<CameraBackend> backend;
  ExposureOf exposure_of;
};

/// A camera of the matrix and the faults that can happen to it.
struct DriverCase {
  std::string name;
  SensorSpec spec;
  std::vector<DriverFault> faults;
  Rejection truncated_is = Rejection::incomplete;  ///< the reason that a truncated frame is counted by
  std::function<PluggedCamera(const SensorSpec&, std::function<cv::Mat1w(std::uint64_t)>, FaultCommands&)> plug;
};

inline void PrintTo(const DriverCase& camera, std::ostream* out) {
  *out << camera.name;
}

inline std::string to_text(DriverFault fault) {
  constexpr std::array<const char*, 5> names{"Lost", "Truncated", "Shortened", "Frozen", "Swapped"};
  return names.at(static_cast<std::size_t>(fault));
}

/// Which exposure has which fault. Never two in succession, so that each has one reason; the first is certain, so that
/// no rate is without any.
class FaultDraw {
 public:
  static constexpr std::uint64_t first = 12;

  FaultDraw(std::vector<DriverFault> faults, double rate) : faults_(std::move(faults)), rate_(rate) {}
  [[nodiscard]] std::optional<DriverFault> at(std::uint64_t index) const {
    if (faults_.empty() || !drawn(index) || drawn(index - 1) || drawn(index - 2)) return std::nullopt;
    return faults_[random_.sub(1).below(faults_.size(), index)];
  }

 private:
  [[nodiscard]] bool drawn(std::uint64_t index) const {
    return index == first || (index > first && random_.uniform(index) < rate_);
  }
  std::vector<DriverFault> faults_;
  double rate_;
  RandomStream random_{7, "driver faults"};
};

/// An emulated camera whose frames are damaged on the way. The exposures are called on the camera's thread.
class FaultyExposures {
 public:
  FaultyExposures(std::shared_ptr<const SensorModel> model, std::shared_ptr<SceneHolder> holder, FaultDraw draw)
      : model_(std::move(model)), holder_(std::move(holder)), draw_(std::move(draw)) {}

  [[nodiscard]] cv::Mat1w expose(std::uint64_t index) {
    const auto scene = holder_->scene();
    log_.add(index, scene);
    const cv::Mat1w picture = model_->expose(*scene, index);
    const cv::Mat1w before = std::exchange(last_, picture);
    const auto fault = draw_.at(index);
    if (!fault) return picture;
    switch (*fault) {
      case DriverFault::lost:
        commands.lose();
        break;
      case DriverFault::truncated:
        commands.truncate();
        break;
      case DriverFault::shortened:
        commands.shorten();
        break;
      case DriverFault::frozen:
        return before;
      case DriverFault::swapped:
        return with_swapped_bytes(picture);
    }
    return picture;
  }
  [[nodiscard]] const FaultDraw& draw() const { return draw_; }
  [[nodiscard]] cv::Mat1w again(std::uint64_t index) const { return model_->expose(*log_.scene(index), index); }
  FaultCommands commands;

 private:
  std::shared_ptr<const SensorModel> model_;
  std::shared_ptr<SceneHolder> holder_;
  FaultDraw draw_;
  ExposureLog log_;
  cv::Mat1w last_;
};

/// Remembers every frame that it passes on.
class RememberingSource final : public PlainSource {
 public:
  explicit RememberingSource(FrameSource& source) : PlainSource(source.info()), source_(source) {}
  [[nodiscard]] Result<void> start() override { return source_.start(); }
  void stop() override { source_.stop(); }
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds timeout) override {
    auto frame = source_.next(timeout);
    if (frame) frames.push_back(*frame);
    return frame;
  }
  std::vector<Frame> frames;

 private:
  FrameSource& source_;
};

/// Gives frames out.
class FramesOf final : public PlainSource {
 public:
  FramesOf(SourceInfo info, std::vector<Frame> frames) : PlainSource(std::move(info)), frames_(std::move(frames)) {}
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds) override {
    if (at_ == frames_.size()) return fail(ErrorCode::disconnected, "no frame left");
    return frames_[at_++];
  }

 private:
  std::vector<Frame> frames_;
  std::size_t at_ = 0;
};

/// One plate, two contrasts, and as many presentations as are asked for.
struct DriverBench : SimulatedBench {
  DriverBench(const SensorSpec& sensor, int presentations) {
    spec = sensor;
    plates = {two_plates().front()};
    mountings = {Mounting::identity};
    contrasts = {16.9, 1.93};
    phases = presentations;
    PlateScene scene;
    scene.plate = plates.front();
    scene.distance_m = distance_m;
    holder = std::make_shared<SceneHolder>(scene);
    model = std::make_shared<const SensorModel>(spec, full_plan(spec, {}, {}), Accuracy::draft(), seed);
  }
  [[nodiscard]] Result<MeasurementResult> measure_with(FrameSource& source, std::function<std::int64_t()> now_ns,
                                                       const MeasurementListener& listener = {}) const {
    MeasurementOptions options = options_of(*this);
    options.registration_frames = 16;
    options.frames_after_change = 4;
    options.max_rejected_share = 0.9;
    options.frame_timeout = std::chrono::seconds(20);
    options.nuc_wait_s = 0;  // the simulated camera has no shutter whose frames would be waited for
    host->clock = [now_ns = std::move(now_ns)](Moment) { return now_ns(); };
    TemplateObserver observer({}, triangle_alternatives());
    ListedSchedule schedule = schedule_of(*this);
    return measure(source, *scene_target(holder, plates), observer, schedule, options, *host, listener, {});
  }
  std::shared_ptr<SceneHolder> holder;
  std::shared_ptr<const SensorModel> model;
};

/// Why the measurement must not use a frame: what was done to its exposure, or what is missing before it.
inline std::optional<Rejection> reason_of(const DriverCase& camera, const FaultDraw& draw, std::uint64_t exposure,
                                          bool follows_a_gap) {
  const auto fault = draw.at(exposure);
  if (fault == DriverFault::truncated) return camera.truncated_is;
  if (fault == DriverFault::shortened) return Rejection::wrong_size;
  if (fault == DriverFault::swapped) return Rejection::byte_swapped;
  if (follows_a_gap) return Rejection::gapped;
  if (fault == DriverFault::frozen) return Rejection::frozen;
  return std::nullopt;
}

/// What the measurement has to say about the frames that came.
struct ExpectedCounts {
  std::map<std::string, std::uint64_t> rejected;
  std::uint64_t lost = 0;
  std::vector<Frame> good;               ///< numbered as they came
  std::vector<std::uint64_t> exposures;  ///< of `good`
};

inline ExpectedCounts expected_counts(const DriverCase& camera, const std::vector<Frame>& frames, const FaultDraw& draw,
                                      const ExposureOf& exposure_of) {
  ExpectedCounts out;
  std::optional<std::uint64_t> last;
  for (const auto& frame : frames) {
    const std::uint64_t exposure = exposure_of(frame);
    const std::uint64_t missing = last ? exposure - *last - 1 : 0;
    out.lost += missing;
    last = exposure;
    if (const auto reason = reason_of(camera, draw, exposure, missing > 0)) {
      ++out.rejected[std::string(to_string(*reason))];
    } else {
      out.good.push_back(frame);
      out.exposures.push_back(exposure);
    }
  }
  return out;
}

/// A measurement with the faults at a rate is the one of the simulated camera over the exposures that came whole.
inline void expect_the_answers_without(const DriverCase& camera, const std::vector<DriverFault>& faults, double rate,
                                       int presentations) {
  const DriverBench bench(camera.spec, presentations);
  const auto exposures = std::make_shared<FaultyExposures>(bench.model, bench.holder, FaultDraw(faults, rate));
  const PluggedCamera plugged = camera.plug(
      bench.spec, [exposures](std::uint64_t index) { return exposures->expose(index); }, exposures->commands);
  const auto source = plugged.backend->open(plugged.id);
  ASSERT_TRUE(source) << source.error().message;
  for (const auto& [name, value] : plugged.settings) ASSERT_TRUE((*source)->set(name, value));
  RememberingSource remembering(**source);
  std::vector<std::int64_t> clock;

  const auto measured = bench.measure_with(remembering, [&] { return clock.emplace_back(monotonic_ns()); });

  ASSERT_TRUE(measured) << measured.error().message;
  ASSERT_FALSE(measured->ended_by) << measured->ended_by->message;
  const ExpectedCounts expected = expected_counts(camera, remembering.frames, exposures->draw(), plugged.exposure_of);
  EXPECT_EQ(measured->frames_rejected, expected.rejected);
  EXPECT_EQ(measured->frames_lost, expected.lost);
  EXPECT_GT(expected.lost + remembering.frames.size() - expected.good.size(), 0U) << "nothing happened";

  std::vector<Frame> whole = expected.good;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    whole[i].counts = exposures->again(expected.exposures[i]);
    whole[i].sequence = i;
  }
  FramesOf simulated(remembering.info(), std::move(whole));
  std::size_t at = 0;
  const auto undisturbed = bench.measure_with(simulated, [&] { return clock[std::min(at++, clock.size() - 1)]; });
  ASSERT_TRUE(undisturbed) << undisturbed.error().message;
  ASSERT_FALSE(undisturbed->ended_by) << undisturbed->ended_by->message;
  EXPECT_TRUE(undisturbed->frames_rejected.empty());
  ASSERT_EQ(measured->trials.size(), 2U * static_cast<std::size_t>(presentations) * 20U);
  ASSERT_EQ(undisturbed->trials.size(), measured->trials.size());
  for (std::size_t i = 0; i < measured->trials.size(); ++i) {
    const Trial &with = measured->trials[i], &without = undisturbed->trials[i];
    ASSERT_EQ(with.frame, expected.good.at(without.frame).sequence) << "trial " << i;
    ASSERT_EQ(with.answer, without.answer) << "trial " << i;
    ASSERT_EQ(with.scores, without.scores) << "trial " << i;
    ASSERT_EQ(with.delta_t_k, without.delta_t_k) << "trial " << i;
    ASSERT_EQ(with.phase_x_px, without.phase_x_px) << "trial " << i;
  }
}

}  // namespace todbench::test
