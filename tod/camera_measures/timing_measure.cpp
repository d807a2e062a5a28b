// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/camera_measures/timing_measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "acquisition/base/distributions.h"
#include "acquisition/base/try.h"

namespace todbench {
namespace {

constexpr std::size_t least_timed_frames = 10;

/// Line through times over numbers of frames.
struct TimeLine {
  double period_s = 0, period_u_s = 0, sd_s = 0, largest_s = 0;
};

TimeLine line_through(std::span<const FrameTimes> times, std::int64_t FrameTimes::*clock) {
  const auto n = static_cast<double>(times.size());
  const auto number = [&](const FrameTimes& one) { return static_cast<double>(one.sequence - times[0].sequence); };
  const auto seconds = [&](const FrameTimes& one) { return 1e-9 * static_cast<double>(one.*clock - times[0].*clock); };
  double x = 0, y = 0, xx = 0, xy = 0, rest = 0;
  for (const FrameTimes& one : times) x += number(one) / n, y += seconds(one) / n;
  for (const FrameTimes& one : times) {
    xx += std::pow(number(one) - x, 2);
    xy += (number(one) - x) * (seconds(one) - y);
  }
  TimeLine line{.period_s = xy / xx};
  for (const FrameTimes& one : times) {
    const double off = seconds(one) - y - line.period_s * (number(one) - x);
    rest += off * off;
    line.largest_s = std::max(line.largest_s, std::abs(off));
  }
  line.sd_s = std::sqrt(rest / (n - 2));
  line.period_u_s = line.sd_s / std::sqrt(xx);
  return line;
}

constexpr double half_percent = 0.025;
constexpr double stamp_step_ms = 1e-6;  // time stamps are whole nanoseconds

/// Times that deviate from the line by less than a step of the time stamps show no jitter.
Estimate seen_jitter(const Estimate& jitter_ms) {
  if (jitter_ms.value >= stamp_step_ms) return jitter_ms;
  return {0, 0, std::max(jitter_ms.high, stamp_step_ms)};
}

}  // namespace

Result<TimingMeasure> frame_timing(std::span<const FrameTimes> times) {
  if (times.size() < least_timed_frames) return fail(ErrorCode::invalid_input, "fewer than ten frames");
  TimingMeasure out{.frames = static_cast<int>(times.size())};
  out.device_clock = std::ranges::all_of(times, [](const FrameTimes& one) { return one.device_ns > 0; });
  const auto clock = out.device_clock ? &FrameTimes::device_ns : &FrameTimes::host_ns;
  for (std::size_t i = 1; i < times.size(); ++i) {
    if (times[i].sequence <= times[i - 1].sequence || times[i].*clock <= times[i - 1].*clock)
      return fail(ErrorCode::invalid_input, "numbers or times of the frames do not rise");
    const std::uint64_t missing = times[i].sequence - times[i - 1].sequence - 1;
    out.lost += missing;
    out.longest_gap = std::max(out.longest_gap, missing);
  }
  const TimeLine line = line_through(times, clock);
  const double freedom = static_cast<double>(times.size()) - 2;
  const double t = quantile(distribution::StudentsT(freedom), 1 - half_percent);
  out.rate_hz = {1 / line.period_s, 1 / (line.period_s + t * line.period_u_s),
                 1 / (line.period_s - t * line.period_u_s)};
  const auto of_jitter = [&](double probability) {
    return 1e3 * line.sd_s * std::sqrt(freedom / quantile(distribution::ChiSquared(freedom), probability));
  };
  out.jitter_ms = seen_jitter({1e3 * line.sd_s, of_jitter(1 - half_percent), of_jitter(half_percent)});
  out.largest_deviation_ms = out.jitter_ms.value > 0 ? 1e3 * line.largest_s : 0;
  if (out.device_clock) out.arrival_ms = 1e3 * line_through(times, &FrameTimes::host_ns).sd_s;
  return out;
}

Result<TimingMeasure> measure_timing(FrameTaker& taker, int frames, const std::stop_token& stop) {
  std::vector<FrameTimes> times;
  const std::uint64_t lost = taker.lost();
  for (int k = 0; k < frames; ++k) {
    TODBENCH_TRY(const Frame frame, taker.next(stop));
    times.push_back({frame.sequence, frame.device_time_ns, frame.host_time_ns});
  }
  TODBENCH_TRY(TimingMeasure out, frame_timing(times));
  // Rejected frames arrived: a gap of the good frames is not a loss of the camera.
  out.lost = taker.lost() - lost;
  if (out.lost == 0) out.longest_gap = 0;
  return out;
}

namespace {

/// Frames of one run, until the plate is at rest by the clock of the camera.
Result<std::vector<Frame>> frames_of(FrameTaker& taker, const PlateRun& run, const std::stop_token& stop) {
  std::vector<Frame> frames;
  const double end_s = *run.start_s + run.duration_s();
  constexpr std::size_t most = 10000;
  while (frames.size() < most) {
    TODBENCH_TRY(Frame frame, taker.next_of_moving_scene(stop));
    const double time_s = 1e-9 * static_cast<double>(frame.device_time_ns);
    if (time_s > end_s) break;
    if (time_s > *run.start_s) frames.push_back(std::move(frame));
  }
  return frames;
}

/// Times in ms by which the frames of a run are behind the plate.
Result<std::vector<double>> lags_of(const std::vector<Frame>& frames, const PlateRun& run, const PlaceInFrame& place) {
  constexpr std::size_t least = 4, lead = 4;  // the first frames show the start of the motion
  std::vector<double> lags_ms;
  for (std::size_t i = lead; i < frames.size(); ++i) {
    const double gone_s = 1e-9 * static_cast<double>(frames[i].device_time_ns) - *run.start_s;
    const double expected_mm = run.from_mm + run.direction() * run.speed_mm_s * gone_s;
    const auto seen_mm = place(frames[i], expected_mm);
    if (!seen_mm) continue;
    lags_ms.push_back(1e3 * run.direction() * (expected_mm - *seen_mm) / run.speed_mm_s);
  }
  if (lags_ms.size() < least)
    return fail(ErrorCode::invalid_input,
                fmt::format("a run of the stage gave {} usable frames, at least {} are needed: choose a lower speed",
                            lags_ms.size(), least));
  return lags_ms;
}

}  // namespace

Result<LatencyMeasure> measure_latency(FrameTaker& taker, MovingTarget* stage, const PutAt& put,
                                       const PlaceInFrame& place, const LatencyOptions& options,
                                       const std::stop_token& stop) {
  if (stage == nullptr) return fail(ErrorCode::invalid_input, "the stage has no runs at constant speed");
  LatencyMeasure out{.speed_mm_s = options.speed_mm_s};
  for (int k = 0; k < options.runs; ++k) {
    const double from_mm = (k % 2 == 0 ? -0.5 : 0.5) * options.travel_mm;
    TODBENCH_TRY_VOID(put(from_mm));
    TODBENCH_TRY(const PlateRun run, stage->run_along_x(-from_mm, options.speed_mm_s, stop));
    if (!run.start_s)
      return fail(ErrorCode::invalid_input, "the stage does not state the start of a run in the clock of the camera");
    TODBENCH_TRY(const std::vector<Frame> frames, frames_of(taker, run, stop));
    TODBENCH_TRY(const std::vector<double> lags_ms, lags_of(frames, run, place));
    out.runs_ms.push_back(std::accumulate(lags_ms.begin(), lags_ms.end(), 0.0) / static_cast<double>(lags_ms.size()));
    out.frames_ms.insert(out.frames_ms.end(), lags_ms.begin(), lags_ms.end());
  }
  const auto n = static_cast<double>(out.runs_ms.size());
  const double mean = std::accumulate(out.runs_ms.begin(), out.runs_ms.end(), 0.0) / n;
  double squares = 0;
  for (const double one : out.runs_ms) squares += (one - mean) * (one - mean);
  const double half =
      n < 2 ? 0 : quantile(distribution::StudentsT(n - 1), 1 - half_percent) * std::sqrt(squares / (n - 1) / n);
  out.latency_ms = {mean, mean - half, mean + half};
  return out;
}

}  // namespace todbench
