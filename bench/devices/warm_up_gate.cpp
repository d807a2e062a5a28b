// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/devices/warm_up_gate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "acquisition/base/distributions.h"
#include "acquisition/base/try.h"

namespace todbench {
namespace {

constexpr std::size_t least_points = 10;
constexpr double seconds_per_minute = 60;
/// Share of the window that the frames must span.
constexpr double full_share = 0.95;
constexpr double corrected_jitter_s = 0.5;

std::string drift_words(const std::optional<Estimate>& drift) {
  if (!drift) return "no drift could be computed, because corrections of the camera interrupted every window";
  return fmt::format("it drifts by {:.3g} K/min (95 %: {:.3g} to {:.3g})", drift->value, drift->low, drift->high);
}

class Gate {
 public:
  Gate(FrameSource& source, const WarmUpPlan& plan, const FrameTakerOptions& taking, const std::stop_token& stop)
      : plan_(plan), taker_(source, taking), stop_(stop), window_(plan.window_s) {}

  Result<std::string> operator()() {
    for (;;) {
      TODBENCH_TRY(const double time_s, next());
      const auto drift = window_.k_per_min();
      if (drift) last_ = drift;
      if (time_s >= plan_.time_s && slow(drift)) return met(time_s, drift);
      if (plan_.drift_k_per_min > 0 && time_s >= std::max(plan_.timeout_s, plan_.time_s))
        return fail(ErrorCode::calibration,
                    fmt::format("the warm-up did not end within {:g} s: {}, but [camera.warm_up] allows {:g} K/min. "
                                "Wait longer, or check the camera and its surroundings",
                                plan_.timeout_s, drift_words(last_), plan_.drift_k_per_min));
    }
  }

 private:
  /// Takes a frame and returns its time since the first one.
  Result<double> next() {
    TODBENCH_TRY(const Frame frame, taker_.next(stop_));
    TODBENCH_TRY(const cv::Mat1d kelvin, to_kelvin(frame));
    if (!first_ns_) first_ns_ = frame.host_time_ns;
    const double time_s = 1e-9 * static_cast<double>(frame.host_time_ns - *first_ns_);
    const double since_s = taker_.since_nuc_s(frame);
    if (since_s >= 0 && (since_s_ < 0 || since_s < since_s_ - corrected_jitter_s)) window_.clear();
    since_s_ = since_s;
    window_.add(time_s, cv::mean(kelvin)[0]);
    return time_s;
  }

  /// Whether both ends of the interval are within the bound.
  [[nodiscard]] bool slow(const std::optional<Estimate>& drift) const {
    if (!(plan_.drift_k_per_min > 0)) return true;
    return drift && std::max(-drift->low, drift->high) < plan_.drift_k_per_min;
  }

  [[nodiscard]] std::string met(double time_s, const std::optional<Estimate>& drift) const {
    std::string text = fmt::format("the camera warmed up for {:.1f} s before the run", time_s);
    if (plan_.drift_k_per_min > 0)
      text += fmt::format(": {}, below {:g} K/min", drift_words(drift), plan_.drift_k_per_min);
    return text;
  }

  const WarmUpPlan& plan_;
  FrameTaker taker_;
  const std::stop_token& stop_;
  DriftWindow window_;
  std::optional<Estimate> last_;
  std::optional<std::int64_t> first_ns_;
  double since_s_ = -1;
};

}  // namespace

void DriftWindow::add(double time_s, double level_k) {
  points_.push_back({time_s, level_k});
  while (points_.back().time_s - points_.front().time_s > window_s_) points_.pop_front();
}

std::optional<Estimate> DriftWindow::k_per_min() const {
  if (points_.size() < least_points || points_.back().time_s - points_.front().time_s < full_share * window_s_)
    return std::nullopt;
  const auto n = static_cast<double>(points_.size());
  double x = 0, y = 0, xx = 0, xy = 0, rest = 0;
  for (const LevelAt& one : points_) x += one.time_s / n, y += one.level_k / n;
  for (const LevelAt& one : points_) {
    xx += std::pow(one.time_s - x, 2);
    xy += (one.time_s - x) * (one.level_k - y);
  }
  const double slope = xy / xx;
  for (const LevelAt& one : points_) rest += std::pow(one.level_k - y - slope * (one.time_s - x), 2);
  const double half = quantile(distribution::StudentsT(n - 2), 0.975) * std::sqrt(rest / (n - 2) / xx);
  return Estimate{seconds_per_minute * slope, seconds_per_minute * (slope - half), seconds_per_minute * (slope + half)};
}

Result<std::string> wait_for_warm_up(FrameSource& source, const WarmUpPlan& plan, const FrameTakerOptions& taking,
                                     const std::stop_token& stop) {
  if (!plan.stated()) return std::string();
  TODBENCH_TRY_VOID(source.start());
  auto done = Gate(source, plan, taking, stop)();
  source.stop();
  return done;
}

}  // namespace todbench
