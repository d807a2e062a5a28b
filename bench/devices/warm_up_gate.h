// SPDX-License-Identifier: GPL-3.0-or-later
// Wait before a run until the camera has warmed up.
#pragma once

#include <deque>
#include <optional>
#include <stop_token>
#include <string>

#include "acquisition/base/interval.h"
#include "acquisition/core/frame_source.h"
#include "bench/plan/plan.h"
#include "tod/measurement/frame_taker.h"

namespace todbench {

/// Levels (K) of the frames of the last `window_s` seconds, and the drift computed from these levels.
class DriftWindow {
 public:
  explicit DriftWindow(double window_s) : window_s_(window_s) {}
  /// Adds the level of a frame.
  void add(double time_s, double level_k);
  /// Discards all levels. Call it after a correction, because levels before and after a correction are not comparable.
  void clear() { points_.clear(); }
  /// Returns the slope with its 95 % interval in K/min, by least squares; empty before the window is full, or with
  /// fewer than ten frames.
  [[nodiscard]] std::optional<Estimate> k_per_min() const;

 private:
  struct LevelAt {
    double time_s = 0, level_k = 0;
  };
  double window_s_;
  std::deque<LevelAt> points_;
};

/// Starts the source, reads frames until the conditions of `plan` are met, and stops the source. Returns a sentence on
/// the warm-up; empty without conditions. Errors: `calibration` (the camera still drifts at the end of the time limit),
/// those of FrameTaker::next().
[[nodiscard]] Result<std::string> wait_for_warm_up(FrameSource& source, const WarmUpPlan& plan,
                                                   const FrameTakerOptions& taking, const std::stop_token& stop);

}  // namespace todbench
