// SPDX-License-Identifier: GPL-3.0-or-later
// Display of a run on the terminal: phases, progress, waits, the TOD curve as it develops.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "bench/cli/console.h"
#include "bench/run/experiment.h"
#include "bench/run/live_curve.h"

namespace todbench {

/// Returns a listener that shows phases, notes, progress and waits, without the curve.
[[nodiscard]] ExperimentListener listener_of(Console& console);

/// Display of a run with the curve: a picture on a terminal, otherwise an occasional line. Must outlive the run.
class RunDisplay {
 public:
  /// Viewers of the curve: the terminal alone, or other viewers too, for which the curve is always fitted.
  enum class Curve { of_the_terminal, of_others_too };
  RunDisplay(Console& console, const Plan& plan, Curve curve = Curve::of_the_terminal);

  /// Returns the listener of the run.
  [[nodiscard]] ExperimentListener listener();
  /// Returns the latest fitted curve; null if the curve has no viewer.
  [[nodiscard]] const LiveCurve* curve() const { return curve_ ? &*curve_ : nullptr; }

 private:
  using Clock = std::chrono::steady_clock;
  void show();

  Console& console_;
  Plan plan_;
  Clock::time_point last_line_ = Clock::now();
  std::uint64_t shown_version_ = 0;
  std::optional<LiveCurve> curve_;
};

}  // namespace todbench
