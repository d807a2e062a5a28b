// SPDX-License-Identifier: GPL-3.0-or-later
// Timing of a camera: frame rate, jitter and gaps, and the latency, which is measured with a stage that uses the clock
// of the camera.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "acquisition/base/interval.h"
#include "acquisition/base/result.h"
#include "tod/measurement/frame_taker.h"
#include "tod/presentation/moving_target.h"

namespace todbench {

/// Times of one frame.
struct FrameTimes {
  std::uint64_t sequence = 0;
  std::int64_t device_ns = 0;  ///< 0: the camera has no clock
  std::int64_t host_ns = 0;
};

/// Result of frame_timing().
struct TimingMeasure {
  int frames = 0;
  std::optional<double> stated_rate_hz{};
  bool device_clock = false;  ///< true: times of the camera's clock; false: times of arrival
  Estimate rate_hz{};
  Estimate jitter_ms{};             ///< standard deviation of the times from a straight line over the frame numbers
  double largest_deviation_ms = 0;  ///< largest deviation of a time from that line
  /// Standard deviation of the times of arrival from a straight line over the frame numbers.
  std::optional<double> arrival_ms{};
  std::uint64_t lost = 0;         ///< frames that never arrived
  std::uint64_t longest_gap = 0;  ///< largest number of successive lost frames
};

/// Returns the timing of frames. The frames must be in the order of arrival. Errors: `invalid_input` (fewer than ten
/// frames, times that do not increase).
[[nodiscard]] Result<TimingMeasure> frame_timing(std::span<const FrameTimes> times);

/// Takes frames and returns their timing. Errors: those of FrameTaker::next() and frame_timing().
[[nodiscard]] Result<TimingMeasure> measure_timing(FrameTaker& taker, int frames, const std::stop_token& stop);

/// Options of measure_latency().
struct LatencyOptions {
  double speed_mm_s = 100;  ///< speed of the plate
  double travel_mm = 20;    ///< distance of a run
  int runs = 8;             ///< number of runs, alternately to the right and to the left
};

/// Result of measure_latency().
struct LatencyMeasure {
  double speed_mm_s = 0;
  std::vector<double> runs_ms{};    ///< latency in each run
  std::vector<double> frames_ms{};  ///< latency in each frame of the runs
  /// Time stamp of a frame minus the time at which the target was at the position shown in the frame. The latency
  /// includes the time constant of the detector and half of the exposure. Positive: the frame is late.
  Estimate latency_ms{};
};

/// Returns the position of the plate in a frame, in mm along the x axis of the stage; empty: not found.
using PlaceInFrame = std::function<std::optional<double>(const Frame& frame, double expected_mm)>;
/// Presents the plate at a position along x, in mm.
using PutAt = std::function<Result<void>(double x_mm)>;

/// Measures the latency in runs of the stage. Errors: those of stage and camera; `invalid_input` (a stage that cannot
/// run or does not use the camera's clock, or too few frames in a run).
[[nodiscard]] Result<LatencyMeasure> measure_latency(FrameTaker& taker, MovingTarget* stage, const PutAt& put,
                                                     const PlaceInFrame& place, const LatencyOptions& options,
                                                     const std::stop_token& stop);

}  // namespace todbench
