// SPDX-License-Identifier: GPL-3.0-or-later
// Noise of a camera and of an observer over a window without a scene.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "acquisition/base/accuracy.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Noise by draw number; each draw has its own fixed pattern. Dead detectors are left out. Immutable, thread-safe.
class WindowNoise {
 public:
  /// Precondition: `spec` is as_planned().
  WindowNoise(const SensorSpec& spec, const SensorPlan& plan, const Accuracy& accuracy, cv::Size window_samples,
              std::uint64_t seed);
  /// Creates the noise of a square window.
  WindowNoise(const SensorSpec& spec, const SensorPlan& plan, const Accuracy& accuracy, int window_samples,
              std::uint64_t seed)
      : WindowNoise(spec, plan, accuracy, cv::Size(window_samples, window_samples), seed) {}
  /// Returns the noise of the camera after its display, in kelvin.
  [[nodiscard]] cv::Mat1f sensor_k(std::uint64_t draw) const { return sensor_frames_k(draw, 1).front(); }
  /// Returns the noise of `count` successive frames, which share the fixed pattern of the draw; the first equals
  /// sensor_k().
  [[nodiscard]] std::vector<cv::Mat1f> sensor_frames_k(std::uint64_t draw, int count) const;
  /// Returns white noise of sd 1.
  [[nodiscard]] cv::Mat1f white(std::uint64_t draw) const;

 private:
  SensorSpec small_;
  SensorPlan plan_;
  Accuracy accuracy_;
  cv::Size window_;  ///< size of the window in samples
  int margin_ = 0;
  std::uint64_t seed_;
};

}  // namespace todbench
