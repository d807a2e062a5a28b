// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/window_noise.h"

#include <span>

#include "acquisition/base/rng.h"
#include "sim_devices/sensor/effect_display.h"
#include "sim_devices/sensor/sensor_model.h"

namespace todbench {

WindowNoise::WindowNoise(const SensorSpec& spec, const SensorPlan& plan, const Accuracy& accuracy,
                         cv::Size window_samples, std::uint64_t seed)
    : small_(spec), plan_(plan), accuracy_(accuracy), window_(window_samples), seed_(seed) {
  if (has_display(spec)) {
    margin_ = static_cast<int>(taps_of([&](double f) { return display_response(spec, f); }).size());
  }
  small_.width = (window_.width + 2 * margin_) / spec.samples_per_pitch() + 1;
  small_.height = (window_.height + 2 * margin_) / spec.samples_per_pitch() + 1;
  small_.dead_pixel_share = 0;
}

std::vector<cv::Mat1f> WindowNoise::sensor_frames_k(std::uint64_t draw, int count) const {
  const SensorModel model(small_, plan_, accuracy_, seed_ + 1000003 * (draw + 1));
  const cv::Mat1f nothing = cv::Mat1f::zeros(model.size());
  std::vector<cv::Mat1f> frames;
  for (int k = 0; k < count; ++k) {
    const cv::Mat1f picture = model.picture(nothing, 1, small_.scene_temperature_k, static_cast<std::uint64_t>(k));
    frames.push_back(picture(cv::Rect({margin_, margin_}, window_)).clone());
  }
  return frames;
}

cv::Mat1f WindowNoise::white(std::uint64_t draw) const {
  cv::Mat1f out(window_);
  RandomStream(seed_, "identification.white").sub(draw).fill_normal(std::span(out.ptr<float>(), out.total()));
  return out;
}

}  // namespace todbench
