// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/identification_passes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim_devices/prediction/identification_views.h"
#include "sim_devices/sensor/effect_image_dance.h"

namespace todbench {
namespace {

constexpr double fastest_px_per_frame = 5;

int frames_of(const IdentificationTask& task) {
  return task.sequence == SequenceObserver::single_frame ? 1 : task.frames;
}

cv::Point nearest_sample(cv::Point2d place) {
  return {static_cast<int>(std::floor(place.x + 0.5)), static_cast<int>(std::floor(place.y + 0.5))};
}

/// Steps of a search to the sample, of its reach, and of half a sample.
struct SearchSteps {
  int per_sample, reach, half_a_sample;
  explicit SearchSteps(const TemplateObserverSpec& spec)
      : per_sample(static_cast<int>(std::lround(1 / spec.search_step_samples))),
        reach(static_cast<int>(std::lround(spec.search_range_samples * per_sample))),
        half_a_sample((per_sample + 1) / 2) {}
  [[nodiscard]] int wide() const { return 2 * (reach + half_a_sample) + 1; }
};

}  // namespace

cv::Point2d step_of_pass(const SensorSpec& spec, SceneMotion motion) {
  return cv::Point2d(motion.x_mrad_s, motion.y_mrad_s) *
         (spec.samples_per_pitch() / spec.ifov_mrad() / spec.frame_rate_hz);
}

Result<void> check_passes(const IdentificationTask& task) {
  const auto refuse = [](const char* why) { return fail(ErrorCode::invalid_input, why); };
  const cv::Point2d step = step_of_pass(task.sensor, task.motion) / task.sensor.samples_per_pitch();
  if (!(std::hypot(step.x, step.y) <= fastest_px_per_frame))
    return refuse("identification needs a motion of at most 5 pixels per frame");
  if (task.motion.moving() && task.sensor.samples_per_pitch() != 1)
    return refuse("identification of targets in motion needs a camera without microscan and super-resolution");
  if (task.sequence == SequenceObserver::single_frame) return {};
  if (task.frames < 1) return refuse("a pass needs at least one frame");
  if (task.plan.simulates(Effect::image_dance))
    return refuse(
        "passes of several frames do not simulate the image dance of short frames: set "
        "turbulence_correlation_ms to 0, which makes every frame the long exposure");
  return {};
}

IdentificationPasses::IdentificationPasses(const IdentificationTask& task, const SensorSpec& spec,
                                           const SeenWindow& window, double transmittance,
                                           std::vector<AlternativeAspects> shown, int side)
    : task_(task),
      spec_(spec),
      window_(window),
      transmittance_(transmittance),
      shown_(std::move(shown)),
      step_(step_of_pass(spec, task.motion)),
      frames_(frames_of(task)),
      side_(side),
      picture_(side + 2 * static_cast<int>(std::ceil((frames_ - 1) * std::max(std::abs(step_.x), std::abs(step_.y))))),
      noise_(spec, task.plan, task.accuracy, picture_, task.seed) {}

cv::Rect IdentificationPasses::window_at(cv::Point2d place) const {
  const int corner = (picture_ - side_) / 2;
  return {nearest_sample(place) + cv::Point(corner, corner), cv::Size(side_, side_)};
}

IdentificationPasses::Signals IdentificationPasses::signals(std::size_t target, std::size_t aspect,
                                                            std::size_t phase) const {
  Signals out;
  // A whole number of samples puts the middle of the pass into the middle of the picture.
  const cv::Point2d first = view_offset(phase) - cv::Point2d(nearest_sample(step_ * ((frames_ - 1) / 2.0)));
  for (int k = 0; k < frames_; ++k) {
    const cv::Point2d place = first + step_ * static_cast<double>(k);
    out.places.push_back(place);
    out.corners.push_back(window_at(place).tl());
    if (k > 0 && step_ == cv::Point2d(0, 0)) {
      out.frames.push_back(out.frames.front());
      continue;
    }
    out.frames.push_back(window_.picture(shown_[target][aspect], side_, place - cv::Point2d(nearest_sample(place)),
                                         transmittance_, presentation_of(phase, target, aspect)));
  }
  return out;
}

std::vector<PassWindow> IdentificationPasses::windows(const Signals& signals, std::uint64_t draw) const {
  std::vector<cv::Mat1f> frames = noise_.sensor_frames_k(draw, frames_);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    cv::Mat1f inside = frames[k](cv::Rect(signals.corners[k], cv::Size(side_, side_)));
    inside += signals.frames[k];
  }
  const auto seen = [&](const cv::Mat1f& frame, cv::Point2d place) {
    return PassWindow{frame(window_at(place)).clone(), place - cv::Point2d(nearest_sample(place))};
  };
  if (task_.sequence == SequenceObserver::static_sum) {
    cv::Mat1f mean = cv::Mat1f::zeros(frames.front().size());
    for (const cv::Mat1f& frame : frames) mean += frame / static_cast<double>(frames.size());
    return {seen(mean, (signals.places.front() + signals.places.back()) / 2)};
  }
  std::vector<PassWindow> out;
  for (std::size_t k = 0; k < frames.size(); ++k) out.push_back(seen(frames[k], signals.places[k]));
  return out;
}

TemplateObserverSpec searching_at_true_places(TemplateObserverSpec spec) {
  const SearchSteps steps(spec);
  spec.search_range_samples += static_cast<double>(steps.half_a_sample) / steps.per_sample;
  return spec;
}

std::size_t places_of_search(const TemplateObserverSpec& spec) {
  const auto side = static_cast<std::size_t>(2 * SearchSteps(spec).reach + 1);
  return side * side;
}

void add_centred(const TemplateObserverSpec& spec, std::span<const float> wide, cv::Point2d phase, float share,
                 std::span<float> own) {
  const SearchSteps steps(spec);
  const int right = static_cast<int>(std::lround(phase.x * steps.per_sample)) + steps.half_a_sample;
  const int down = static_cast<int>(std::lround(phase.y * steps.per_sample)) + steps.half_a_sample;
  const int side = 2 * steps.reach + 1;
  const std::size_t per_view = places_of_search(spec),
                    per_wide_view = static_cast<std::size_t>(steps.wide() * steps.wide());
  for (std::size_t view = 0; view < own.size() / per_view; ++view) {
    const float* from = &wide[view * per_wide_view];
    float* to = &own[view * per_view];
    for (int y = 0; y < side; ++y) {
      const float* row = from + (y + down) * steps.wide() + right;
      for (int x = 0; x < side; ++x) *to++ += share * row[x];
    }
  }
}

}  // namespace todbench
