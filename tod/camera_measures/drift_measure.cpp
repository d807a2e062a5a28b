// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/camera_measures/drift_measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "acquisition/base/try.h"

namespace todbench {
namespace {

/// A recording that the next correction ends after a fifth still has eight of these groups.
constexpr int short_groups = 40;
constexpr std::size_t most_short_groups = 24;  // more are joined in pairs

/// Sums frames by the time since the correction.
class DriftGroups {
 public:
  explicit DriftGroups(double group_s) : group_s_(group_s) {}

  void add(double since_s, const Frame& frame, const cv::Mat1d& kelvin) {
    if (!first_s_) first_s_ = since_s, first_ = {frame.sequence, frame.device_time_ns};
    const CameraMoment now{frame.sequence, frame.device_time_ns};
    last_ = now;
    const int at = static_cast<int>((since_s - *first_s_) / group_s_);
    if (at != open_at_ || groups_.empty()) {
      open_at_ = at;
      groups_.push_back({.time_s = 0, .frames = 0, .mean_k = cv::Mat1d::zeros(kelvin.size())});
      by_camera_s_.push_back(0);
    }
    by_camera_s_.back() += *first_s_ + seconds_between(first_, now);
    DriftGroup& group = groups_.back();
    group.time_s += since_s, group.mean_k += kelvin, ++group.frames;
  }
  /// Means of the groups that have at least half as many frames as the largest: the last one may be cut off.
  [[nodiscard]] std::vector<DriftGroup> finished(double frame_rate_hz) && {
    if (camera_has_clock(frame_rate_hz)) {
      for (std::size_t k = 0; k < groups_.size(); ++k) groups_[k].time_s = by_camera_s_[k];
    }
    int most = 0;
    for (const DriftGroup& group : groups_) most = std::max(most, group.frames);
    std::erase_if(groups_, [&](const DriftGroup& group) { return 2 * group.frames < most; });
    if (groups_.size() > most_short_groups) join_pairs();
    for (DriftGroup& group : groups_) group.time_s /= group.frames, group.mean_k /= group.frames;
    return std::move(groups_);
  }

 private:
  struct CameraMoment {
    std::uint64_t sequence = 0;
    std::int64_t device_time_ns = 0;
  };
  static double seconds_between(const CameraMoment& from, const CameraMoment& to) {
    return 1e-9 * static_cast<double>(to.device_time_ns - from.device_time_ns);
  }
  /// Frames arrive late on a busy host; a clock that counts them at the stated rate gives their exposure times.
  [[nodiscard]] bool camera_has_clock(double frame_rate_hz) const {
    constexpr double tolerance = 0.02;
    const auto frames = static_cast<double>(last_.sequence - first_.sequence);
    const double counted_s = frame_rate_hz > 0 ? frames / frame_rate_hz : 0;
    return counted_s > 0 && std::abs(seconds_between(first_, last_) - counted_s) <= tolerance * counted_s;
  }

  void join_pairs() {
    std::vector<DriftGroup> pairs;
    for (std::size_t k = 0; k + 1 < groups_.size(); k += 2) {
      DriftGroup pair = groups_[k];
      const DriftGroup& next = groups_[k + 1];
      pair.time_s += next.time_s, pair.mean_k += next.mean_k, pair.frames += next.frames;
      pairs.push_back(std::move(pair));
    }
    groups_ = std::move(pairs);
  }

  double group_s_;
  std::optional<double> first_s_;
  CameraMoment first_, last_;
  int open_at_ = 0;
  std::vector<DriftGroup> groups_;
  std::vector<double> by_camera_s_;  ///< sums, as the times of the groups are while frames are added
};

/// A reported correction arrives with the delays of the frames: a smaller difference is not a new correction.
constexpr double told_jitter_s = 0.5;
constexpr double longest_lag_s = 5;  // of that time after the host's clock

double host_s(const Frame& frame) {
  return static_cast<double>(frame.host_time_ns) * 1e-9;
}

/// The first frame after a correction that the camera made by itself.
Result<Frame> after_own_correction(FrameTaker& taker, double wait_s, const std::stop_token& stop) {
  std::optional<double> began_s;
  double last_s = -1;
  for (;;) {
    auto frame = taker.next(stop);
    if (!frame) return frame;
    const double since_s = taker.since_nuc_s(*frame);
    // One that is known from the first frame on may be long ago.
    if (began_s && since_s >= 0 && (last_s < 0 || since_s < last_s - told_jitter_s)) return frame;
    if (!began_s) began_s = host_s(*frame);
    last_s = since_s;
    if (host_s(*frame) - *began_s > wait_s) {
      return fail(ErrorCode::integrity,
                  fmt::format("no correction of the camera was commanded, reported or detected within {:g} s", wait_s));
    }
  }
}

}  // namespace

Result<DriftMeasure> measure_drift(FrameTaker& taker, const cv::Rect& field, const DriftOptions& options,
                                   const std::stop_token& stop) {
  auto frame =
      options.commanded || options.simulated ? taker.next(stop) : after_own_correction(taker, options.drift_s, stop);
  if (!frame) return tl::unexpected(frame.error());
  const std::int64_t began_ns = frame->device_time_ns;
  const auto since_correction_s = [&](const Frame& taken) {
    return options.simulated ? 1e-9 * static_cast<double>(taken.device_time_ns - began_ns) : taker.since_nuc_s(taken);
  };
  const double first_s = since_correction_s(*frame);
  if (first_s < 0) return fail(ErrorCode::integrity, "the time of the camera's correction is unknown");
  DriftGroups groups(options.drift_s / short_groups);
  DriftMeasure measure;
  double last_s = first_s;
  const double began_s = host_s(*frame);
  for (;;) {
    TODBENCH_TRY(const auto kelvin, window_kelvin(*frame, field));
    groups.add(last_s, *frame, kelvin);
    frame = taker.next(stop);
    if (!frame) return tl::unexpected(frame.error());
    const double since_s = since_correction_s(*frame);
    measure.ended_by_correction = since_s < last_s - told_jitter_s;
    if (measure.ended_by_correction || since_s - first_s >= options.drift_s) break;
    if (!options.simulated && host_s(*frame) - began_s > options.drift_s + longest_lag_s)
      return fail(ErrorCode::integrity, "the camera reports a time since its correction that does not advance");
    last_s = std::max(last_s, since_s);
  }
  const std::vector<DriftGroup> means = std::move(groups).finished(options.frame_rate_hz);
  if (means.size() < least_drift_groups) {
    return fail(
        ErrorCode::integrity,
        fmt::format(
            "the fit of the drift needs at least {2} groups of frames, but the {1:.1f} s after a correction gave {0}",
            means.size(), last_s, least_drift_groups));
  }
  TODBENCH_TRY(auto law, drift_law(means));
  measure.groups = static_cast<int>(means.size());
  measure.frames_each = std::min_element(means.begin(), means.end(), [](const DriftGroup& a, const DriftGroup& b) {
                          return a.frames < b.frames;
                        })->frames;
  measure.first_s = means.front().time_s, measure.last_s = means.back().time_s;
  measure.law = std::move(law);
  return measure;
}

}  // namespace todbench
