// SPDX-License-Identifier: GPL-3.0-or-later
// TOD curve of a running measurement, fitted on its own thread.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <vector>

#include "bench/plan/plan.h"
#include "bench/session/session_folder.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Fits to the answers that have arrived.
struct FittedCurves {
  std::uint64_t version = 0;  ///< increases with every fit
  std::optional<TodCurve> measured, twin;
};

/// Fits the answers that have arrived, about once a second on its own thread. The run does not wait for the fit. Uses
/// the same function as the result (RunningFit). Any thread.
class LiveCurve {
 public:
  explicit LiveCurve(const Plan& plan);

  /// Adds an answer to the next fit.
  void add(SessionCurve curve, const Trial& trial);
  /// Returns the latest fit; null before the first.
  [[nodiscard]] std::shared_ptr<const FittedCurves> latest() const;

 private:
  void work(const std::stop_token& stop);

  Plan plan_;
  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::vector<Trial> measured_, twin_;
  bool trials_changed_ = false;
  std::shared_ptr<const FittedCurves> latest_;
  std::jthread worker_;  // last: it uses everything above
};

}  // namespace todbench
