// A run as the terminal shows it: phases, progress, what is waited for, the curve as it grows.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "bench/cli/console.h"
#include "bench/run/experiment.h"
#include "bench/run/live_curve.h"

namespace todbench {

/// Phases, notes, progress and waits; without the curve.
[[nodiscard]] ExperimentListener listener_of(Console& console);

/// The same with the curve: a picture on a terminal, a line now and again elsewhere. Outlives the run.
class ShownRun {
 public:
  /// Who looks at the curve.
  enum class Curve { of_the_terminal, of_others_too };
  ShownRun(Console& console, const Plan& plan, Curve curve = Curve::of_the_terminal);

  [[nodiscard]] ExperimentListener listener();
  /// The curve, fitted as it grows; null where nobody looks.
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
