// SPDX-License-Identifier: GPL-3.0-or-later
// Visits of an adaptive schedule to its set-ups.
#pragma once

#include <cstddef>
#include <vector>

#include "bench/plan/plan.h"

namespace todbench {

/// A set-up by the numbers of its plate and mounting.
struct NumberedSetUp {
  std::size_t plate = 0, mounting = 0;
};

/// Returns the set-ups of a plan, plate by plate.
[[nodiscard]] std::vector<NumberedSetUp> numbered_set_ups(const Plan& plan, std::size_t plates);

/// A visit of an adaptive schedule to a set-up.
struct AdaptiveVisit {
  std::size_t set_up = 0;            ///< index in numbered_set_ups()
  std::vector<int> presentations{};  ///< at each contrast of the plan
};
/// Visits of a simulated run of an adaptive schedule.
using AdaptiveRun = std::vector<AdaptiveVisit>;

/// Returns the presentations of each run; if there are no runs, those of one run to the cap of the plan. `listed`: all
/// presentations of a visit to each set-up, set-up by set-up. A run also shows the highest contrast at least once in
/// each new set-up. Precondition: `listed` is not empty and has the set-ups and contrasts of the plan.
[[nodiscard]] std::vector<std::vector<TargetState>> visited_presentations(const Plan& plan,
                                                                          const std::vector<TargetState>& listed,
                                                                          const std::vector<AdaptiveRun>& runs);

/// Order of the visits of AdaptiveSchedule if all set-ups are equally informative. The next visit goes to the set-up
/// with the lowest price (n + 1) t / c. n is the number of earlier visits to the set-up, t the time of its changes and
/// presentations, and c the number of contrasts for which the visit is useful.
class VisitOrder {
 public:
  /// `set_ups`: at least one.
  VisitOrder(const Plan& plan, std::vector<NumberedSetUp> set_ups);

  /// Begins the next visit, which shows this number of contrasts. `useful_here`: number of these contrasts for which
  /// more presentations in the same set-up reduce the interval. Returns the index of the set-up.
  [[nodiscard]] std::size_t next(int contrasts, int useful_here);

  /// Returns the number of visits to each set-up.
  [[nodiscard]] const std::vector<int>& visits() const { return visits_; }

 private:
  std::vector<NumberedSetUp> set_ups_;
  std::vector<int> visits_;
  ConstantStimuliOptions stimuli_;
  std::size_t now_ = 0;
  bool begun_ = false;
};

}  // namespace todbench
