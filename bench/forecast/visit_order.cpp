// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/forecast/visit_order.h"

#include <cassert>

#include "bench/plan/plan_options.h"
#include "tod/schedule/adaptive_schedule.h"

namespace todbench {

std::vector<NumberedSetUp> numbered_set_ups(const Plan& plan, std::size_t plates) {
  std::vector<NumberedSetUp> out;
  for (std::size_t plate = 0; plate < plates; ++plate) {
    const auto mountings = static_cast<std::size_t>(mountings_of(plan.target, plate));
    for (std::size_t mounting = 0; mounting < mountings; ++mounting) out.push_back({plate, mounting});
  }
  return out;
}

VisitOrder::VisitOrder(const Plan& plan, std::vector<NumberedSetUp> set_ups)
    : set_ups_(std::move(set_ups)),
      visits_(set_ups_.size()),
      stimuli_(stimuli_options(plan, {}, 1, plan.camera.id.empty() ? Side::simulated : Side::measured)) {
  assert(!set_ups_.empty());
}

std::size_t VisitOrder::next(int contrasts) {
  const auto price = [&](std::size_t i) {
    const NumberedSetUp &there = set_ups_[i], &here = set_ups_[now_];
    return (1 + visits_[i]) * visit_seconds(stimuli_, begun_ && there.plate != here.plate,
                                            begun_ && there.mounting != here.mounting, contrasts);
  };
  std::size_t best = 0;
  for (std::size_t i = 1; i < set_ups_.size(); ++i) {
    if (price(i) < price(best)) best = i;
  }
  now_ = best;
  begun_ = true;
  ++visits_[best];
  return best;
}

}  // namespace todbench
