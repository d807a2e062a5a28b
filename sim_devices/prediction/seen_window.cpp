#include "sim_devices/prediction/seen_window.h"

#include "sim_devices/sensor/effect_display.h"

namespace todbench {

SeenWindow::SeenWindow(const SensorSpec& spec, const SceneImager& imager) : imager_(&imager) {
  if (has_display(spec)) taps_ = taps_of([&](double f) { return display_response(spec, f); });
}

cv::Mat1f SeenWindow::picture(const std::vector<StepEdge>& edges, int window_samples, cv::Point2d offset,
                              double factor) const {
  const int margin = static_cast<int>(taps_.size()) / 2, side = window_samples + 2 * margin;
  const double centre = (side - 1) / 2.0;
  cv::Mat1f seen;
  imager_->image(placed(edges, 1, 0, {centre + offset.x, centre + offset.y}), {side, side})
      .convertTo(seen, CV_32F, factor);
  if (!taps_.empty()) seen = filtered(seen, taps_);
  return seen(cv::Rect(margin, margin, window_samples, window_samples)).clone();
}

}  // namespace todbench
