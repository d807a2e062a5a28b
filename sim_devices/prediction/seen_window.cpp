// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/seen_window.h"

#include "sim_devices/sensor/effect_display.h"
#include "sim_devices/sensor/effect_image_dance.h"

namespace todbench {

SeenWindow::SeenWindow(const SensorSpec& spec, const SceneImager& imager) : spec_(spec), imager_(&imager) {
  if (has_display(spec)) taps_ = taps_of([&](double f) { return display_response(spec, f); });
}

cv::Mat1f SeenWindow::picture(const std::vector<StepEdge>& edges, int window_samples, cv::Point2d offset, double factor,
                              std::uint64_t number) const {
  const int margin = static_cast<int>(taps_.size()) / 2, side = window_samples + 2 * margin;
  const double centre = (side - 1) / 2.0;
  std::vector<cv::Point2d> exposures = spread_dance_pitch(spec_, number);
  if (exposures.empty()) exposures.emplace_back(0, 0);
  cv::Mat1d signal;
  for (const cv::Point2d& displacement : exposures) {
    const cv::Point2d at = cv::Point2d(centre, centre) + offset + spec_.samples_per_pitch() * displacement;
    const cv::Mat1d exposed = imager_->image(placed(edges, 1, 0, at), {side, side});
    signal = signal.empty() ? exposed : cv::Mat1d(signal + exposed);
  }
  cv::Mat1f seen;
  signal.convertTo(seen, CV_32F, exposures.size() == 1 ? factor : factor / static_cast<double>(exposures.size()));
  if (!taps_.empty()) seen = filtered(seen, taps_);
  return seen(cv::Rect(margin, margin, window_samples, window_samples)).clone();
}

}  // namespace todbench
