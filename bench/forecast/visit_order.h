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

/// The visits of AdaptiveSchedule if all set-ups are equally informative: each visit is the one whose changes and
/// presentations take least time, and a set-up that was visited n times counts 1 / (n + 1).
class VisitOrder {
 public:
  /// `set_ups`: at least one.
  VisitOrder(const Plan& plan, std::vector<NumberedSetUp> set_ups);

  /// Index of the next set-up, for a visit that shows this number of contrasts.
  [[nodiscard]] std::size_t next(int contrasts);

 private:
  std::vector<NumberedSetUp> set_ups_;
  std::vector<int> visits_;
  ConstantStimuliOptions stimuli_;
  std::size_t now_ = 0;
  bool begun_ = false;
};

}  // namespace todbench
