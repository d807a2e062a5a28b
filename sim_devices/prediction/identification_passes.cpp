// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/identification_passes.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "acquisition/base/try.h"
#include "sim_devices/prediction/identification_views.h"
#include "sim_devices/sensor/effect_quantisation.h"
#include "sim_devices/sensor/effect_row.h"
#include "tod/measurement/lag_differences.h"

namespace todbench {
namespace {

constexpr double fastest_px_per_frame = 5;
/// Samples round the window in which a target is drawn into a whole picture.
constexpr int surround_in_whole_picture = 16;
/// Frames at rest that measure contrast and noise behind the stages.
constexpr int frames_of_scale = 32;
constexpr std::uint64_t draw_of_scale = 1ULL << 40U;  ///< after those of all passes
constexpr double least_gain_over_error = 3;

int frames_of(const IdentificationTask& task) {
  return task.sequence == SequenceObserver::single_frame ? 1 : task.frames;
}

cv::Point nearest_sample(cv::Point2d place) {
  return {static_cast<int>(std::floor(place.x + 0.5)), static_cast<int>(std::floor(place.y + 0.5))};
}

SensorPlan without_quantisation(SensorPlan plan) {
  for (auto& d : plan.decisions) {
    if (d.effect == Effect::quantisation) d.decision = Decision::skip;
  }
  return plan;
}

/// Copies whose values are their own.
std::vector<cv::Mat1f> copies_of(const std::vector<cv::Mat1f>& frames) {
  std::vector<cv::Mat1f> out;
  for (const cv::Mat1f& frame : frames) out.push_back(frame.clone());
  return out;
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

cv::Mat1d without_mean(const cv::Mat& picture) {
  cv::Mat1d out;
  picture.convertTo(out, CV_64F);
  return out - cv::mean(out)[0];
}

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
  if (std::ranges::find(identification_sequences, task.sequence) == identification_sequences.end())
    return refuse("identification has no super-resolution of a pass");
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
      side_(side) {
  for (const auto& target : shown_) scales_.emplace_back(target.size());
}

Result<std::unique_ptr<const IdentificationPasses>> IdentificationPasses::of(
    const IdentificationTask& task, const SensorSpec& spec, const SeenWindow& window, double transmittance,
    std::vector<AlternativeAspects> shown, int side) {
  std::unique_ptr<IdentificationPasses> out(
      new IdentificationPasses(task, spec, window, transmittance, std::move(shown), side));
  const int travel =
      static_cast<int>(std::ceil((out->frames_ - 1) * std::max(std::abs(out->step_.x), std::abs(out->step_.y))));
  out->picture_ = cv::Size(side, side) + cv::Size(2 * travel, 2 * travel);
  if (task.stages) {
    TODBENCH_TRY_VOID(out->prepare_stages());
  }
  out->noise_.emplace(spec, task.stages ? without_quantisation(task.plan) : task.plan, task.accuracy, out->picture_,
                      task.seed);
  if (task.stages) {
    TODBENCH_TRY_VOID(out->measure_scales());
  }
  return std::unique_ptr<const IdentificationPasses>(std::move(out));
}

Result<void> IdentificationPasses::prepare_stages() {
  for (const auto& stage : task_.stages()) lead_ += stage->memory_frames();
  if (task_.stage_reach_px) {
    surround_ = *task_.stage_reach_px;
    picture_ += cv::Size(2 * surround_, 2 * surround_);
    return {};
  }
  surround_ = surround_in_whole_picture;
  const cv::Size needed = picture_;
  picture_ = cv::Size(spec_.width, spec_.height) * spec_.samples_per_pitch();
  if (needed.width > picture_.width || needed.height > picture_.height)
    return fail(
        ErrorCode::invalid_input,
        "a stage needs the whole picture of the camera, and the targets with their surround do not fit into it: " +
            std::to_string(needed.width) + " samples. Choose longer ranges");
  return {};
}

cv::Rect IdentificationPasses::window_at(cv::Point2d place) const {
  const cv::Point corner((picture_.width - side_) / 2, (picture_.height - side_) / 2);
  return {nearest_sample(place) + corner, cv::Size(side_, side_)};
}

IdentificationPasses::Signals IdentificationPasses::signals(std::size_t target, std::size_t aspect,
                                                            std::size_t phase) const {
  Signals out;
  // A whole number of samples puts the middle of the pass into the middle of the picture.
  const cv::Point2d first = view_offset(phase) - cv::Point2d(nearest_sample(step_ * ((frames_ - 1) / 2.0)));
  for (int k = -lead_; k < frames_; ++k) {
    const cv::Point2d place = first + step_ * static_cast<double>(k);
    out.places.push_back(place);
    out.corners.push_back(window_at(place).tl() - cv::Point(surround_, surround_));
    if (k > -lead_ && step_ == cv::Point2d(0, 0)) {
      out.frames.push_back(out.frames.front());
      continue;
    }
    out.frames.push_back(window_.picture(shown_[target][aspect], side_ + 2 * surround_,
                                         place - cv::Point2d(nearest_sample(place)), transmittance_,
                                         presentation_of(phase, target, aspect)));
  }
  return out;
}

Result<void> IdentificationPasses::through_stages(std::vector<cv::Mat1f>& frames) const {
  std::vector<std::unique_ptr<ChainStage>> stages;
  {
    const std::scoped_lock lock(mutex_);
    stages = std::move(without_memory_);
    without_memory_.clear();
  }
  if (stages.empty()) stages = task_.stages();
  const Quantiser quantiser(spec_, spec_.scene_temperature_k);
  for (cv::Mat1f& frame : frames) {
    for (float& value : frame) value = static_cast<float>(quantiser.count(value));
    for (const auto& stage : stages) {
      TODBENCH_TRY(frame, stage->process(frame));
    }
    frame.convertTo(frame, CV_32F, spec_.kelvin_per_count, spec_.offset_k - spec_.scene_temperature_k);
  }
  if (lead_ > 0) return {};
  const std::scoped_lock lock(mutex_);
  without_memory_ = std::move(stages);
  return {};
}

Result<std::vector<cv::Mat1f>> IdentificationPasses::shown_frames(std::vector<cv::Mat1f> noise,
                                                                  const Signals& signals) const {
  for (std::size_t k = 0; k < noise.size(); ++k) {
    const cv::Mat1f& signal = signals.frames[std::min(k, signals.frames.size() - 1)];
    const cv::Rect at(signals.corners[std::min(k, signals.corners.size() - 1)], signal.size());
    const cv::Rect inside = at & cv::Rect({0, 0}, picture_);
    if (inside.empty()) continue;
    cv::Mat1f shown = noise[k](inside);
    shown += signal(inside - at.tl());
  }
  if (!task_.stages) return noise;
  TODBENCH_TRY_VOID(through_stages(noise));
  noise.erase(noise.begin(), noise.begin() + lead_);
  return noise;
}

Result<IdentificationPasses::ViewGain> IdentificationPasses::gain_of(std::size_t target, std::size_t aspect,
                                                                     const std::vector<cv::Mat1f>& noise,
                                                                     const std::vector<cv::Mat1f>& empty) const {
  constexpr std::size_t phase = 5;  // next to the middle of a sample
  const cv::Rect window = window_at(view_offset(phase));
  const cv::Mat1f shown = window_.picture(shown_[target][aspect], side_ + 2 * surround_, view_offset(phase),
                                          transmittance_, presentation_of(phase, target, aspect));
  double low = 0, high = 0;
  cv::minMaxLoc(shown, &low, &high);
  if (reaches_an_end(spec_, high, spec_.scene_temperature_k) || reaches_an_end(spec_, low, spec_.scene_temperature_k))
    return fail(
        ErrorCode::invalid_input,
        "target " + task_.targets[target].name +
            " reaches the lowest or highest count of the camera, so its pictures are clipped in front of the stages");
  TODBENCH_TRY(const auto judged,
               shown_frames(copies_of(noise), {{shown}, {window.tl() - cv::Point(surround_, surround_)}, {}}));
  const cv::Mat1d in_front = without_mean(shown(cv::Rect(surround_, surround_, side_, side_)));
  ViewGain out{.energy = in_front.dot(in_front)};
  std::vector<double> products;
  LagDifferences noise_in_front(frames_of_scale), noise_behind(frames_of_scale);
  for (std::size_t k = 0; k < judged.size(); ++k) {
    // Both have the same noise, so a linear stage has no error.
    products.push_back(without_mean(judged[k](window) - empty[k](window)).dot(in_front));
    noise_in_front.add(k, without_mean(noise[k + static_cast<std::size_t>(lead_)](window)));
    noise_behind.add(k, without_mean(judged[k](window)));
  }
  const auto count = static_cast<double>(products.size());
  out.product = std::accumulate(products.begin(), products.end(), 0.0) / count;
  for (const double product : products) out.variance += std::pow(product - out.product, 2) / (count * (count - 1));
  if (noise_in_front.variance() > 0) out.noise_ratio = std::sqrt(noise_behind.variance() / noise_in_front.variance());
  return out;
}

Result<void> IdentificationPasses::measure_scales() {
  const std::vector<cv::Mat1f> noise = noise_->sensor_frames_k(draw_of_scale, lead_ + frames_of_scale);
  TODBENCH_TRY(const auto empty, shown_frames(copies_of(noise), {{cv::Mat1f::zeros(1, 1)}, {{0, 0}}, {}}));
  std::vector<std::vector<ViewGain>> gains;
  ViewGain all;
  double views = 0;
  for (std::size_t t = 0; t < shown_.size(); ++t) {
    auto& own = gains.emplace_back();
    for (std::size_t a = 0; a < shown_[t].size(); ++a) {
      if (task_.stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
      TODBENCH_TRY(const auto view, gain_of(t, a, noise, empty));
      own.push_back(view);
      all.product += view.product, all.energy += view.energy, all.variance += view.variance;
      views += 1;
    }
  }
  if (!std::isfinite(all.product) || !(std::abs(all.product) > least_gain_over_error * std::sqrt(all.variance)))
    return fail(ErrorCode::not_identifiable, "behind the processing stages the targets have no contrast");
  judged_ = {.gain = all.gain(), .least_gain = gains[0][0].gain(), .largest_gain = gains[0][0].gain()};
  for (std::size_t t = 0; t < gains.size(); ++t) {
    for (std::size_t a = 0; a < gains[t].size(); ++a) {
      const ViewGain& view = gains[t][a];
      scales_[t][a] = {.contrast = std::abs(view.gain() / judged_->gain),
                       .noise = view.noise_ratio / std::abs(judged_->gain)};
      judged_->least_gain = std::min(judged_->least_gain, view.gain());
      judged_->largest_gain = std::max(judged_->largest_gain, view.gain());
      judged_->noise_k += std::sqrt(white_variance_k2(spec_, task_.plan, 1)) * scales_[t][a].noise / views;
    }
  }
  return {};
}

Result<std::vector<PassWindow>> IdentificationPasses::windows(const Signals& signals, std::uint64_t draw) const {
  TODBENCH_TRY(const auto frames, shown_frames(noise_->sensor_frames_k(draw, lead_ + frames_), signals));
  const double gain = judged_ ? judged_->gain : 1;
  const auto seen = [&](const cv::Mat1f& frame, cv::Point2d place) {
    cv::Mat1f kelvin = frame(window_at(place)).clone();
    if (gain != 1) kelvin /= gain;
    return PassWindow{kelvin, place - cv::Point2d(nearest_sample(place))};
  };
  const cv::Point2d* const places = &signals.places[static_cast<std::size_t>(lead_)];
  if (task_.sequence == SequenceObserver::static_sum) {
    cv::Mat1f mean = cv::Mat1f::zeros(picture_);
    for (const cv::Mat1f& frame : frames) mean += frame / static_cast<double>(frames.size());
    return std::vector<PassWindow>{seen(mean, (places[0] + places[frames.size() - 1]) / 2)};
  }
  std::vector<PassWindow> out;
  for (std::size_t k = 0; k < frames.size(); ++k) out.push_back(seen(frames[k], places[k]));
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
