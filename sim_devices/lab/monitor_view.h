// A monitor before an emulated camera: what its pixels show is what the camera sees.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>

#include "acquisition/core/accuracy.h"
#include "acquisition/core/result.h"
#include "sim_devices/sensor/scene_image.h"
#include "sim_devices/sensor/sensor_model.h"

namespace todbench {

struct Monitor {
  double pixel_mm = 0.25;  ///< centre to centre, square, each a lit square of that size; at most a pitch of the camera
  double span_k = 20;      ///< contrast of white beside black, as the camera sees it; > 0
  double gamma = 1;        ///< light of a level from 0 to 1 is level^gamma; > 0
  /// The levels that it shows now, the same object as long as they are the same; null: black. Called with every
  /// exposure, from the thread of the camera. What is round the picture has the level of its first pixel.
  std::function<std::shared_ptr<const cv::Mat1f>()> levels{};
};

/// The camera looks at the middle of the monitor. One thread at a time.
class MonitorView {
 public:
  /// `model` outlives it. `centre_px`: where the middle of the monitor is, from the middle of the picture.
  /// `invalid_input`: a pixel of the monitor is larger than a pitch of the camera, a number is not above 0.
  [[nodiscard]] static Result<MonitorView> make(Monitor monitor, const SensorModel& model, Accuracy accuracy,
                                                double distance_m, cv::Point2d centre_px);

  /// Frame `index` of the monitor as it is. Half of its light is `scene_temperature_k` of the sensor.
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
  std::shared_ptr<const cv::Mat1f> seen_;  ///< the levels that signal_ belongs to
  cv::Mat1f signal_;                       ///< of the light above that round the picture, as a part of white
  double surround_ = 0;                    ///< light round the picture
};

}  // namespace todbench
