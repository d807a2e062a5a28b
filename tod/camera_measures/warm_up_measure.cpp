// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/camera_measures/warm_up_measure.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "acquisition/base/try.h"
#include "tod/measures/shading.h"

namespace todbench {
namespace {

constexpr int warm_up_groups = 40;
constexpr int least_frames = 4, most_frames = 64;
/// Frames of a group if the camera states no rate.
constexpr int usual_frames = 8;
constexpr double corrected_jitter_s = 0.5;
/// Largest difference of the camera's clock from the host's: delay of a frame, and share of the time.
constexpr double late_s = 0.5, clock_tolerance = 0.02;

double pattern_of(const AveragedPicture& picture, int frames) {
  const Shading shading = shading_of(picture.kelvin);
  cv::Scalar mean, sd;
  cv::meanStdDev(picture.kelvin - shading.surface, mean, sd);
  return std::sqrt(std::max(0.0, sd[0] * sd[0] - picture.temporal_noise_k * picture.temporal_noise_k / frames));
}

/// Groups of the longest stretch without a correction. A group with one may contain frames before and behind it.
std::span<const DriftGroup> undisturbed(const std::vector<DriftGroup>& all, const std::vector<WarmUpGroup>& groups) {
  std::size_t best = 0, best_size = 0, first = 0;
  for (std::size_t i = 0; i <= all.size(); ++i) {
    if (i < all.size() && !groups[i].corrected) continue;
    if (i - first > best_size) best = first, best_size = i - first;
    first = i + 1;
  }
  return std::span(all).subspan(best, best_size);
}

std::optional<TemperatureDrift> temperature_drift(const std::vector<WarmUpGroup>& groups) {
  std::vector<std::pair<double, double>> points;
  for (const WarmUpGroup& group : groups) {
    if (group.camera_temperature_c) points.emplace_back(*group.camera_temperature_c, group.mean_k);
  }
  if (points.size() < 3) return std::nullopt;
  const auto n = static_cast<double>(points.size());
  double x = 0, y = 0, xx = 0, xy = 0, rest = 0;
  for (const auto& [t, level] : points) x += t / n, y += level / n;
  for (const auto& [t, level] : points) xx += (t - x) * (t - x), xy += (t - x) * (level - y);
  if (!(xx > 0)) return std::nullopt;
  const double slope = xy / xx;
  for (const auto& [t, level] : points) rest += std::pow(level - y - slope * (t - x), 2);
  return TemperatureDrift{slope, std::sqrt(rest / (n - 2) / xx)};
}

/// Takes the groups one after the other.
class WarmUpTaker {
 public:
  WarmUpTaker(FrameTaker& taker, const WarmUpOptions& options, const std::stop_token& stop)
      : taker_(taker), options_(options), stop_(stop) {
    const double fitting = options.frame_rate_hz * options.duration_s / warm_up_groups;
    frames_ = options.frame_rate_hz > 0 ? static_cast<int>(std::clamp<double>(fitting, least_frames, most_frames))
                                        : usual_frames;
  }

  Result<WarmUpGroup> take(DriftGroup& drift) {
    double sum_s = 0;
    bool corrected = false;
    const auto picture = taker_.average(frames_, stop_, [&](const Frame& frame, const cv::Mat1d&) {
      sum_s += seconds_of(frame);
      corrected = note_correction(frame) || corrected;
    });
    if (!picture) return tl::unexpected(picture.error());
    drift = {.time_s = options_.start_s + sum_s / frames_, .frames = frames_, .mean_k = picture->kelvin};
    return WarmUpGroup{.time_s = drift.time_s,
                       .frames = frames_,
                       .mean_k = cv::mean(picture->kelvin)[0],
                       .pattern_k = pattern_of(*picture, frames_),
                       .noise_k = picture->temporal_noise_k,
                       .corrected = corrected || std::exchange(corrected_between_, false)};
  }
  /// Discards frames until `until_s` after the first one.
  Result<void> wait(double until_s) {
    while (last_s_ < until_s) {
      TODBENCH_TRY(const auto frame, taker_.next(stop_));
      (void)seconds_of(frame);
      corrected_between_ = note_correction(frame) || corrected_between_;
    }
    return {};
  }
  [[nodiscard]] double last_s() const { return last_s_; }

 private:
  double seconds_of(const Frame& frame) {
    if (!first_) first_ = frame;
    const auto since = [](std::int64_t from, std::int64_t to) { return 1e-9 * static_cast<double>(to - from); };
    const double by_host_s = since(first_->host_time_ns, frame.host_time_ns);
    const double by_camera_s = since(first_->device_time_ns, frame.device_time_ns);
    // Frames arrive late on a busy host; the camera's clock gives the times of their exposures, if it is one.
    const double tolerance_s = late_s + clock_tolerance * by_host_s;
    const bool has_clock = frame.device_time_ns > 0 && std::abs(by_camera_s - by_host_s) <= tolerance_s;
    return last_s_ = has_clock ? by_camera_s : by_host_s;
  }
  bool note_correction(const Frame& frame) {
    const double since_s = taker_.since_nuc_s(frame);
    const bool again =
        since_s >= 0 && last_since_s_ && (*last_since_s_ < 0 || since_s < *last_since_s_ - corrected_jitter_s);
    last_since_s_ = since_s;
    return again;
  }

  FrameTaker& taker_;
  const WarmUpOptions& options_;
  const std::stop_token& stop_;
  int frames_ = usual_frames;
  std::optional<Frame> first_;
  double last_s_ = 0;
  std::optional<double> last_since_s_;
  bool corrected_between_ = false;
};

}  // namespace

std::optional<double> stable_from(const DriftLaw& law, double k_per_min) {
  const double first = law.time_s.front(), last = law.time_s.back(), rate = k_per_min / 60;
  const DriftFit& level = law.level;
  if (level.shape == DriftShape::linear || !level.time_constant_s)
    return std::abs(level.change_k) / (last - first) < rate ? std::optional(first) : std::nullopt;
  // Times from the first group on: the amplitude there.
  const double constant = *level.time_constant_s;
  const double amplitude = std::abs(level.change_k) / -std::expm1(-(last - first) / constant);
  const double from = first + std::max(0.0, constant * std::log(amplitude / (constant * rate)));
  return from <= last ? std::optional(from) : std::nullopt;
}

Result<WarmUp> measure_warm_up(FrameTaker& taker, const WarmUpOptions& options,
                               const ReadCameraTemperature& temperature, const std::stop_token& stop) {
  WarmUp out;
  std::vector<DriftGroup> drift;
  WarmUpTaker groups(taker, options, stop);
  for (int k = 0; k < warm_up_groups && groups.last_s() < options.duration_s; ++k) {
    TODBENCH_TRY(auto group, groups.take(drift.emplace_back()));
    if (temperature) group.camera_temperature_c = temperature();
    out.groups.push_back(group);
    TODBENCH_TRY_VOID(groups.wait((k + 1) * options.duration_s / warm_up_groups));
  }
  const auto quiet = undisturbed(drift, out.groups);
  if (quiet.size() < least_drift_groups) {
    out.reasons.push_back("no law of drift: the camera corrected itself before eight groups of frames");
  } else if (auto law = drift_law(quiet)) {
    out.law = std::move(*law);
    out.stable_s = stable_from(*out.law, options.stable_k_per_min);
    if (!out.stable_s) out.reasons.push_back("the level drifts faster than the bound up to the end");
  } else {
    out.reasons.push_back("no law of drift: " + law.error().message);
  }
  out.by_temperature = temperature_drift(out.groups);
  if (!out.by_temperature)
    out.reasons.push_back("no drift against the camera's temperature: it is not reported, or it did not change");
  return out;
}

}  // namespace todbench
