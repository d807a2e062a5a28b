// SPDX-License-Identifier: GPL-3.0-or-later
// Simulated sensor: a pure function from scene and index to a frame.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "acquisition/base/accuracy.h"
#include "acquisition/base/rng.h"
#include "hvs/shape/polygon_image.h"
#include "sim_devices/scene/plate_scene.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Simulated sensor. Immutable except for internal caches; thread-safe. The same (scene, index) gives the same frame on
/// every machine and thread.
class SensorModel {
 public:
  /// Precondition: validate(spec) succeeds.
  SensorModel(SensorSpec spec, SensorPlan plan, Accuracy accuracy, std::uint64_t seed);
  ~SensorModel();
  SensorModel(const SensorModel&) = delete;
  SensorModel& operator=(const SensorModel&) = delete;

  /// Returns the sensor as planned: parameters of skipped effects have their neutral values.
  [[nodiscard]] const SensorSpec& spec() const;
  /// Returns the planned effects.
  [[nodiscard]] const SensorPlan& plan() const;
  /// Returns the seed of the random numbers.
  [[nodiscard]] std::uint64_t seed() const;

  /// Returns the size of a picture in samples: detectors times samples per pitch.
  [[nodiscard]] cv::Size size() const;
  /// Returns the picture before noise for a contrast of 1 K, in kelvin above the surround, without the displacement by
  /// image dance. The most recent geometries are cached.
  [[nodiscard]] std::shared_ptr<const cv::Mat1f> unit_signal(const PlateScene& scene) const;
  /// Returns the displacement by image dance of each exposure of picture `index`, in samples; the mean is 0.
  [[nodiscard]] std::vector<cv::Point2d> displacements_px(std::uint64_t index) const;
  /// Returns picture `index` in kelvin above the surround, with the planned effects: signal, temporal and line
  /// noise, fixed pattern, dead pixels, display, quantisation.
  [[nodiscard]] cv::Mat1f picture(const PlateScene& scene, std::uint64_t index) const;
  /// Returns the same picture for an external signal of size() in kelvin per kelvin of contrast, with a surround of
  /// `background_k`. The signal must already contain the image dance.
  [[nodiscard]] cv::Mat1f picture(const cv::Mat1f& unit_signal, double delta_t_k, double background_k,
                                  std::uint64_t index) const;
  /// Returns frame `index` as the camera delivers it: the picture in counts, rounded and clipped to the significant
  /// bits. A frame always contains whole counts, even if the plan skips quantisation.
  [[nodiscard]] cv::Mat1w expose(const PlateScene& scene, std::uint64_t index) const;
  /// Returns the frame for an external signal, as for picture().
  [[nodiscard]] cv::Mat1w expose(const cv::Mat1f& unit_signal, double delta_t_k, double background_k,
                                 std::uint64_t index) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Returns the angle of a sample along x and y.
[[nodiscard]] cv::Point2d sample_mrad(const SensorSpec& spec);

}  // namespace todbench
