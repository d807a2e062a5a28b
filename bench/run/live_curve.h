// The TOD curve of a run while it grows, fitted beside it.
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

/// As fitted to the answers so far.
struct FittedCurves {
  std::uint64_t version = 0;  ///< larger for later ones
  std::optional<TodCurve> measured, twin;
};

/// Fits on a thread of its own, about once a second, so that the run does not wait for it, with the function that the
/// result will have (RunningFit). Any thread.
class LiveCurve {
 public:
  explicit LiveCurve(const Plan& plan);

  void add(SessionCurve curve, const Trial& trial);
  /// Null before the first fit.
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
