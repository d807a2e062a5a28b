// SPDX-License-Identifier: GPL-3.0-or-later
// An emulated camera runs freely, so which exposures a measurement sees differs from run to run: these classes take
// note of them and let the simulated camera expose the same.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "acquisition/base/host_clock.h"
#include "sim_devices/sensor/simulated_camera.h"
#include "tod/presentation/trial.h"

namespace todbench::test {

/// Which scene every exposure of a free-running camera looked at. Thread-safe.
class ExposureLog {
 public:
  void add(std::uint64_t index, std::shared_ptr<const PlateScene> scene) {
    const std::lock_guard lock(mutex_);
    scenes_[index] = std::move(scene);
  }
  [[nodiscard]] std::shared_ptr<const PlateScene> scene(std::uint64_t index) const {
    const std::lock_guard lock(mutex_);
    return scenes_.at(index);
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::uint64_t, std::shared_ptr<const PlateScene>> scenes_;
};

/// A source whose other members are of no interest here.
class PlainSource : public FrameSource {
 public:
  explicit PlainSource(SourceInfo info) : info_(std::move(info)) {}
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] Result<void> start() override { return {}; }
  void stop() override {}
  [[nodiscard]] Result<std::string> get(const std::string&) override { return fail(ErrorCode::invalid_input, ""); }
  [[nodiscard]] Result<void> set(const std::string&, const std::string&) override {
    return fail(ErrorCode::invalid_input, "");
  }
  [[nodiscard]] Result<void> correct_nonuniformity() override { return fail(ErrorCode::invalid_input, ""); }

 private:
  SourceInfo info_;
};

/// Which exposure since power-up a frame is.
using ExposureOf = std::function<std::uint64_t(const Frame&)>;
/// From the clock of a camera whose exposure k is at (k + 1) / rate.
inline ExposureOf exposure_by_clock(double frame_rate_hz) {
  return [frame_rate_hz](const Frame& frame) {
    const double seconds = static_cast<double>(frame.device_time_ns) * 1e-9;
    return static_cast<std::uint64_t>(std::llround(seconds * frame_rate_hz)) - 1;
  };
}

/// The frames of a camera that were exposed to the present scene, numbered anew, and which exposures they are: the
/// camera runs freely, so which ones they are differs from run to run.
class PresentScene final : public PlainSource {
 public:
  PresentScene(FrameSource& camera, const SceneHolder& present, const ExposureLog& log, ExposureOf exposure_of)
      : PlainSource(camera.info()),
        camera_(camera),
        present_(present),
        log_(log),
        exposure_of_(std::move(exposure_of)) {}
  [[nodiscard]] Result<void> start() override { return camera_.start(); }
  void stop() override { camera_.stop(); }
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds timeout) override {
    for (;;) {
      auto frame = camera_.next(timeout);
      if (!frame) return frame;
      const std::uint64_t index = exposure_of_(*frame);
      if (log_.scene(index) != present_.scene()) continue;
      exposures_.push_back(index);
      frame->sequence = exposures_.size() - 1;
      frame->host_time_ns = monotonic_ns();
      return frame;
    }
  }
  [[nodiscard]] const std::vector<std::uint64_t>& exposures() const { return exposures_; }

 private:
  FrameSource& camera_;
  const SceneHolder& present_;
  const ExposureLog& log_;
  ExposureOf exposure_of_;
  std::vector<std::uint64_t> exposures_;
};

/// The simulated camera, exposing the present scene with these indices. Of those that are `spoiled` only a part
/// arrives.
class GivenExposures final : public PlainSource {
 public:
  GivenExposures(SourceInfo info, const SensorModel& model, const SceneHolder& present,
                 std::vector<std::uint64_t> exposures, std::function<bool(std::uint64_t exposure)> spoiled = {})
      : PlainSource(std::move(info)),
        model_(model),
        present_(present),
        exposures_(std::move(exposures)),
        spoiled_(std::move(spoiled)) {}
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds) override {
    if (next_ >= exposures_.size()) return fail(ErrorCode::disconnected, "no exposure left");
    Frame frame;
    frame.counts = model_.expose(*present_.scene(), exposures_[next_]);
    if (spoiled_ && spoiled_(exposures_[next_])) frame.status = FrameStatus::incomplete;
    frame.sequence = next_++;
    frame.host_time_ns = monotonic_ns();
    frame.significant_bits = info().significant_bits;
    frame.correction = CorrectionState::idle;
    frame.scale = std::make_shared<const RadiometricScale>(info().scale);
    return frame;
  }

 private:
  const SensorModel& model_;
  const SceneHolder& present_;
  std::vector<std::uint64_t> exposures_;
  std::function<bool(std::uint64_t exposure)> spoiled_;
  std::size_t next_ = 0;
};

/// The same answers to the same pictures, scores bit for bit.
inline void expect_same_decisions(const std::vector<Trial>& a, const std::vector<Trial>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].frame, b[i].frame) << i;
    ASSERT_EQ(a[i].triangle, b[i].triangle) << i;
    ASSERT_EQ(a[i].answer, b[i].answer) << i;
    ASSERT_EQ(a[i].scores, b[i].scores) << i;
    ASSERT_EQ(a[i].delta_t_k, b[i].delta_t_k) << i;
  }
}

}  // namespace todbench::test
