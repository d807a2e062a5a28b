// SPDX-License-Identifier: GPL-3.0-or-later
// A measurement over the wire whose every frame is known: what was exposed, what arrived, what was used.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "sim_devices/lab/gige/gvsp_camera.h"
#include "tests/support/gige_test_support.h"
#include "tests/tod/measurement/measurement_bench.h"

namespace todbench::test {

/// FNV-1a over the bytes of a picture. Pictures of a sensor with noise are all different.
inline std::uint64_t picture_hash(const cv::Mat1w& picture) {
  std::uint64_t hash = 14695981039346656037U;
  for (const auto count : picture) hash = (hash ^ count) * 1099511628211U;
  return hash;
}

/// What the camera exposed: the truth about every picture.
class ExposureLog {
 public:
  ExposureLog(std::shared_ptr<const SensorModel> model, std::shared_ptr<SceneHolder> holder)
      : model_(std::move(model)), holder_(std::move(holder)) {}

  [[nodiscard]] cv::Mat1w expose(std::uint64_t index) {
    const PlateScene scene = *holder_->scene();
    const std::uint64_t unique = first_ + index;
    cv::Mat1w picture = model_->expose(scene, unique);
    const std::lock_guard lock(mutex_);
    last_ = unique;
    exposed_[picture_hash(picture)] = {unique, scene};
    return picture;
  }
  /// A camera that starts anew counts from 0 again: its exposures are others nevertheless.
  void camera_starts_anew() {
    const std::lock_guard lock(mutex_);
    first_ = last_ + 1;
  }
  [[nodiscard]] bool knows(const cv::Mat1w& picture) const {
    const std::lock_guard lock(mutex_);
    return exposed_.count(picture_hash(picture)) == 1;
  }
  /// The same picture, computed again from scene and index.
  [[nodiscard]] cv::Mat1w again(const cv::Mat1w& picture) const {
    const std::lock_guard lock(mutex_);
    const auto& [index, scene] = exposed_.at(picture_hash(picture));
    return model_->expose(scene, index);
  }

 private:
  std::shared_ptr<const SensorModel> model_;
  std::shared_ptr<SceneHolder> holder_;
  mutable std::mutex mutex_;
  std::uint64_t first_ = 0, last_ = 0;
  std::map<std::uint64_t, std::pair<std::uint64_t, PlateScene>> exposed_;
};

/// Remembers every frame that it passes on.
class LoggingSource final : public FrameSource {
 public:
  explicit LoggingSource(FrameSource& source) : source_(source) {}
  [[nodiscard]] const SourceInfo& info() const override { return source_.info(); }
  [[nodiscard]] Result<void> start() override { return source_.start(); }
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds timeout) override {
    auto frame = source_.next(timeout);
    if (frame) frames.push_back(*frame);
    return frame;
  }
  void stop() override { source_.stop(); }
  [[nodiscard]] Result<std::string> get(const std::string& feature) override { return source_.get(feature); }
  [[nodiscard]] Result<void> set(const std::string& feature, const std::string& value) override {
    return source_.set(feature, value);
  }
  [[nodiscard]] Result<void> correct_nonuniformity() override { return source_.correct_nonuniformity(); }

  std::vector<Frame> frames;

 private:
  FrameSource& source_;
};

/// Gives frames out again.
class ReplayedSource final : public FrameSource {
 public:
  ReplayedSource(SourceInfo info, std::vector<Frame> frames) : info_(std::move(info)), frames_(std::move(frames)) {}
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] Result<void> start() override { return {}; }
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds) override {
    if (at_ == frames_.size()) return fail(ErrorCode::disconnected, "the recording is at its end");
    return frames_[at_++];
  }
  void stop() override {}
  [[nodiscard]] Result<std::string> get(const std::string&) override { return fail(ErrorCode::invalid_input, "none"); }
  [[nodiscard]] Result<void> set(const std::string&, const std::string&) override { return {}; }
  [[nodiscard]] Result<void> correct_nonuniformity() override { return {}; }

 private:
  SourceInfo info_;
  std::vector<Frame> frames_;
  std::size_t at_ = 0;
};

/// One plate, one mounting, two contrasts on a camera at 100 Hz whose counts are those of the sensor.
struct WireBench : SimulatedBench {
  std::shared_ptr<SceneHolder> holder;
  std::shared_ptr<const SensorModel> model;
  std::shared_ptr<ExposureLog> log;
  GvspCameraConfig config;

  explicit WireBench(CameraModel camera_model = CameraModel::ax5) {
    const bool ax5 = camera_model == CameraModel::ax5;
    spec.kelvin_per_count = ax5 ? 0.04 : 0.01;
    spec.offset_k = 0;
    spec.bits = ax5 ? 14 : 16;
    config.model = camera_model;
    config.significant_bits = spec.bits;
    config.kelvin_per_count = spec.kelvin_per_count;
    plates = {two_plates().front()};
    mountings = {Mounting::identity};
    contrasts = {16.9, 1.93};
    phases = 4;
    PlateScene scene;
    scene.plate = plates.front();
    scene.distance_m = distance_m;
    holder = std::make_shared<SceneHolder>(scene);
    model = std::make_shared<const SensorModel>(spec, full_plan(spec, {}, {}), Accuracy::draft(), seed);
    log = std::make_shared<ExposureLog>(model, holder);
    config.width = model->size().width;
    config.height = model->size().height;
    config.frame_rate_hz = 100;
  }

  [[nodiscard]] std::unique_ptr<GvspCamera> camera() const {
    auto camera = GvspCamera::start(config, [log = log](std::uint64_t index) { return log->expose(index); });
    if (camera) return std::move(*camera);
    ADD_FAILURE() << camera.error().message;
    return nullptr;
  }

  [[nodiscard]] MeasurementOptions options() const {
    MeasurementOptions out = options_of(*this);
    out.frames_after_change = 2;
    out.max_rejected_share = 0.9;
    // Two frozen pictures in succession look like a shutter. At 5 % every 400th frame ends such a pair, and a second of
    // waiting after each would be most of the time of a run that needs about 100 frames. Five frames are waited for.
    out.nuc_wait_s = 0.05;
    return out;
  }

  [[nodiscard]] std::size_t trials_of_a_run() const {
    return contrasts.size() * static_cast<std::size_t>(phases) * plates.front().triangles.size();
  }

  [[nodiscard]] Result<MeasurementResult> measure_with(FrameSource& source, const MeasurementOptions& options,
                                                       const MeasurementListener& listener,
                                                       std::stop_token stop = {}) const {
    const auto target = scene_target(holder, plates);
    TemplateObserver observer({}, triangle_alternatives());
    ListedSchedule schedule = schedule_of(*this);
    return measure(source, *target, observer, schedule, options, *host, listener, std::move(stop));
  }
};

/// A run over the wire and what became of its frames.
struct WireRun {
  Result<MeasurementResult> result = fail(ErrorCode::internal, "not run");
  std::vector<Frame> frames;         ///< as they arrived
  std::set<std::uint64_t> rejected;  ///< sequence numbers
  std::vector<std::int64_t> clock;   ///< every look at it
  SourceInfo info;
};

inline WireRun run_over_the_wire(const WireBench& bench, FrameSource& source, MeasurementListener listener = {}) {
  WireRun run;
  LoggingSource logging(source);
  MeasurementOptions options = bench.options();
  options.frame_timeout = std::chrono::milliseconds(500);
  bench.host->clock = [&run](Moment) { return run.clock.emplace_back(monotonic_ns()); };
  listener.on_rejected = [&run](const RejectedFrame& frame) { run.rejected.insert(frame.sequence); };
  run.result = bench.measure_with(logging, options, listener);
  run.frames = std::move(logging.frames);
  run.info = source.info();
  return run;
}

/// The same measurement with every frame that was used computed anew from scene and exposure index, without any wire.
inline Result<MeasurementResult> undisturbed(const WireBench& bench, const WireRun& run) {
  std::vector<Frame> frames = run.frames;
  for (auto& frame : frames) {
    if (run.rejected.count(frame.sequence) == 0) frame.counts = bench.log->again(frame.counts);
  }
  ReplayedSource source(run.info, std::move(frames));
  MeasurementOptions options = bench.options();
  const auto at = std::make_shared<std::size_t>(0);
  *bench.host = TestHost();
  bench.host->clock = [at, clock = run.clock](Moment) { return clock[std::min((*at)++, clock.size() - 1)]; };
  return bench.measure_with(source, options, {});
}

}  // namespace todbench::test
