// SPDX-License-Identifier: GPL-3.0-or-later
// Order in which an adaptive schedule visits the set-ups.
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

/// Order of the visits of AdaptiveSchedule if all set-ups are equally informative. The next visit goes to the set-up
/// with the lowest price: the time of its changes and presentations, times n + 1 for a set-up that was visited n times.
class VisitOrder {
 public:
  /// `set_ups`: at least one.
  VisitOrder(const Plan& plan, std::vector<NumberedSetUp> set_ups);

  /// Begins the next visit, which shows this number of contrasts. Returns the index of its set-up.
  [[nodiscard]] std::size_t next(int contrasts);

 private:
  std::vector<NumberedSetUp> set_ups_;
  std::vector<int> visits_;
  ConstantStimuliOptions stimuli_;
  std::size_t now_ = 0;
  bool begun_ = false;
};

}  // namespace todbench
