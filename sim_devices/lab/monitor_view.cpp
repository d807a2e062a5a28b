// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/monitor_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace todbench {

Result<MonitorView> MonitorView::make(Monitor monitor, const SensorModel& model, Accuracy accuracy, double distance_m,
                                      cv::Point2d centre_px) {
  for (const double number : {monitor.pixel_mm, monitor.span_k, monitor.gamma, distance_m}) {
    if (!(std::isfinite(number) && number > 0))
      return fail(ErrorCode::invalid_input, "the pixel, span, gamma and distance of a monitor must be above 0");
  }
  const SensorSpec& spec = model.spec();
  const double pixel_samples = monitor.pixel_mm / distance_m / spec.ifov_mrad() * spec.samples_per_pitch();
  if (pixel_samples > 1) {
    return fail(
        ErrorCode::invalid_input,
        fmt::format(
            "a monitor pixel of {:g} mm at {:g} m covers {:.2f} samples of the camera; at most 1 can be emulated",
            monitor.pixel_mm, distance_m, pixel_samples));
  }
  return MonitorView(std::move(monitor), model, accuracy, pixel_samples, centre_px);
}

MonitorView::MonitorView(Monitor monitor, const SensorModel& model, Accuracy accuracy, double pixel_samples,
                         cv::Point2d centre_px)
    : monitor_(std::move(monitor)),
      model_(&model),
      imager_(std::make_unique<SceneImager>(model.spec(), model.plan(), accuracy)),
      pixel_samples_(pixel_samples),
      middle_(centre_px + cv::Point2d((model.size().width - 1) / 2.0, (model.size().height - 1) / 2.0)),
      signal_(model.size(), 0.0F) {}

void MonitorView::look(const std::shared_ptr<const cv::Mat1f>& levels) {
  seen_ = levels;
  if (levels == nullptr || levels->empty()) {
    signal_ = cv::Mat1f(model_->size(), 0.0F);
    surround_ = 0;
    return;
  }
  // No panel is darker than black or brighter than white. NaN counts as black.
  const auto light = [&](float level) {
    return std::pow(std::min(1.0, std::max(0.0, static_cast<double>(level))), monitor_.gamma);
  };
  surround_ = light((*levels)(0, 0));
  cv::Mat1d above(levels->size());
  for (int row = 0; row < above.rows; ++row)
    for (int column = 0; column < above.cols; ++column) above(row, column) = light((*levels)(row, column)) - surround_;
  const cv::Point2d first = middle_ - 0.5 * pixel_samples_ * cv::Point2d(above.cols - 1, above.rows - 1);
  imager_->image(above, pixel_samples_, first, model_->size()).convertTo(signal_, CV_32F);
}

cv::Mat1w MonitorView::expose(std::uint64_t index) {
  const auto levels = monitor_.levels ? monitor_.levels() : nullptr;
  if (levels != seen_) look(levels);
  const double background_k = model_->spec().scene_temperature_k + monitor_.span_k * (surround_ - 0.5);
  return model_->expose(signal_, monitor_.span_k, background_k, index);
}

}  // namespace todbench
