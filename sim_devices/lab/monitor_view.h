// SPDX-License-Identifier: GPL-3.0-or-later
// Monitor in front of an emulated camera, which observes the pixels of the monitor.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>

#include "acquisition/base/accuracy.h"
#include "acquisition/base/result.h"
#include "sim_devices/sensor/scene_image.h"
#include "sim_devices/sensor/sensor_model.h"

namespace todbench {

/// Monitor with its present picture.
struct Monitor {
  /// Distance between the centres of pixels, which are lit squares of this side length. The distance must not exceed
  /// the size of a camera sample at the monitor.
  double pixel_mm = 0.25;
  double span_k = 20;  ///< contrast between white and black for the camera; > 0
  double gamma = 1;    ///< the light of a level from 0 to 1 is level^gamma; > 0
  /// Returns the present levels, the same object as long as they are unchanged; null: black. Called for every exposure
  /// on the thread of the camera. The area round the picture has the level of its first pixel.
  std::function<std::shared_ptr<const cv::Mat1f>()> levels{};
};

/// View of the monitor by a camera aimed at its middle. One thread at a time.
class MonitorView {
 public:
  /// Creates the view. `model` must outlive the object. `centre_px`: middle of the monitor, from the middle of the
  /// picture. Errors: `invalid_input` (a pixel of the monitor is larger than a sample of the camera, or a number is not
  /// above 0).
  [[nodiscard]] static Result<MonitorView> make(Monitor monitor, const SensorModel& model, Accuracy accuracy,
                                                double distance_m, cv::Point2d centre_px);

  /// Returns frame `index` of the present monitor in counts. Half of the light of white corresponds to
  /// `scene_temperature_k` of the sensor.
  [[nodiscard]] cv::Mat1w expose(std::uint64_t index);

 private:
  MonitorView(Monitor monitor, const SensorModel& model, Accuracy accuracy, double pixel_samples,
              cv::Point2d centre_px);
  void look(const std::shared_ptr<const cv::Mat1f>& levels);

  Monitor monitor_;
  const SensorModel* model_;
  std::unique_ptr<SceneImager> imager_;
  double pixel_samples_;
  cv::Point2d middle_;
  std::shared_ptr<const cv::Mat1f> seen_;  ///< levels from which signal_ was computed
  cv::Mat1f signal_;                       ///< light minus the light around the picture, as a fraction of white
  double surround_ = 0;                    ///< light round the picture
};

}  // namespace todbench
