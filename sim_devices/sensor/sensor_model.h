// The simulated sensor: a pure function from scene and index to a frame.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "acquisition/core/accuracy.h"
#include "acquisition/core/rng.h"
#include "hvs/shape/polygon_image.h"
#include "sim_devices/scene/plate_scene.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Immutable but for internal caches; thread-safe. The same (scene, index) gives the same frame on every machine and
/// thread.
class SensorModel {
 public:
  /// Precondition: validate(spec) succeeds.
  SensorModel(SensorSpec spec, SensorPlan plan, Accuracy accuracy, std::uint64_t seed);
  ~SensorModel();
  SensorModel(const SensorModel&) = delete;
  SensorModel& operator=(const SensorModel&) = delete;

  /// The sensor as planned: parameters of skipped effects at their neutral values.
  [[nodiscard]] const SensorSpec& spec() const;
  [[nodiscard]] const SensorPlan& plan() const;
  [[nodiscard]] std::uint64_t seed() const;

  /// Picture elements: detectors times samples per pitch.
  [[nodiscard]] cv::Size size() const;
  /// The picture before noise at a contrast of 1 K, above the surround, where it is in the mean of pictures. The last
  /// few geometries are cached.
  [[nodiscard]] std::shared_ptr<const cv::Mat1f> unit_signal(const PlateScene& scene) const;
  /// By how much the dance of the air displaces each of the exposures of picture `index`, in samples; 0 in the mean.
  [[nodiscard]] std::vector<cv::Point2d> displacements_px(std::uint64_t index) const;
  /// Picture `index` in kelvin above the surround: signal, temporal and line noise, fixed pattern, dead
  /// pixels, display, quantisation; each as planned.
  [[nodiscard]] cv::Mat1f picture(const PlateScene& scene, std::uint64_t index) const;
  /// The same for a signal that comes from elsewhere: size() kelvin per kelvin of contrast, before a surround of
  /// `background_k`. It is taken as displaced already.
  [[nodiscard]] cv::Mat1f picture(const cv::Mat1f& unit_signal, double delta_t_k, double background_k,
                                  std::uint64_t index) const;
  /// Frame `index` as the camera delivers it: the picture in counts, rounded and clipped to the significant bits.
  /// Rounds also where the plan skips quantisation, because a frame holds whole counts.
  [[nodiscard]] cv::Mat1w expose(const PlateScene& scene, std::uint64_t index) const;
  /// The same for a signal that comes from elsewhere, as for picture().
  [[nodiscard]] cv::Mat1w expose(const cv::Mat1f& unit_signal, double delta_t_k, double background_k,
                                 std::uint64_t index) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace todbench
