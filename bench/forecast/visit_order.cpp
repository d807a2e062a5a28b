// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/forecast/visit_order.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "bench/plan/plan_options.h"
#include "tod/schedule/adaptive_schedule.h"

namespace todbench {
namespace {

using Strength = std::pair<double, double>;  ///< size of a contrast, and the contrast
Strength strength_of(double delta_t_k) {
  return {std::abs(delta_t_k), delta_t_k};
}

/// Presentations of a set-up in a list, by contrast, the highest first.
using ListedSetUp = std::map<Strength, std::vector<TargetState>, std::greater<>>;

std::vector<ListedSetUp> by_set_ups(const std::vector<TargetState>& listed) {
  std::vector<ListedSetUp> out;
  const TargetState* before = nullptr;
  for (const TargetState& state : listed) {
    if (before == nullptr || state.plate != before->plate || state.mounting != before->mounting) out.emplace_back();
    out.back()[strength_of(state.delta_t_k)].push_back(state);
    before = &state;
  }
  return out;
}

AdaptiveRun run_to_cap(const Plan& plan, const std::vector<ListedSetUp>& set_ups) {
  VisitOrder order(plan, numbered_set_ups(plan, plan.target.plates.size()));
  const std::size_t contrasts = plan.target.delta_t_k.size();
  AdaptiveRun run;
  for (int left = plan.schedule.max_presentations; left > 0;) {
    const auto open = static_cast<int>(contrasts);
    run.push_back({.set_up = order.next(open, open),
                   .presentations = std::vector<int>(contrasts, plan.schedule.max_presentations)});
    for (const auto& [contrast, states] : set_ups[run.back().set_up]) left -= static_cast<int>(states.size());
  }
  return run;
}

}  // namespace

std::vector<std::vector<TargetState>> visited_presentations(const Plan& plan, const std::vector<TargetState>& listed,
                                                            const std::vector<AdaptiveRun>& runs) {
  const std::vector<ListedSetUp> set_ups = by_set_ups(listed);
  const auto cap = static_cast<std::size_t>(std::max(plan.schedule.max_presentations, 0));
  std::vector<std::vector<TargetState>> all;
  for (const AdaptiveRun& run : runs.empty() ? std::vector<AdaptiveRun>{run_to_cap(plan, set_ups)} : runs) {
    std::vector<TargetState>& out = all.emplace_back();
    for (const AdaptiveVisit& visit : run) {
      std::map<Strength, int> shows;
      for (std::size_t i = 0; i < visit.presentations.size(); ++i)
        shows[strength_of(plan.target.delta_t_k[i])] = visit.presentations[i];
      for (const auto& [contrast, states] : set_ups[visit.set_up]) {
        const bool new_set_up =
            out.empty() || out.back().plate != states[0].plate || out.back().mounting != states[0].mounting;
        const auto shown = std::min<std::ptrdiff_t>(std::max(shows[contrast], new_set_up ? 1 : 0), std::ssize(states));
        out.insert(out.end(), states.begin(), states.begin() + shown);
      }
    }
    if (out.size() > cap) out.resize(cap);
  }
  return all;
}

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

std::size_t VisitOrder::next(int contrasts, int useful_here) {
  const auto price = [&](std::size_t i) {
    const NumberedSetUp &there = set_ups_[i], &here = set_ups_[now_];
    const double useful = begun_ && i == now_ ? useful_here : contrasts;  // a price is infinite if this is 0
    return (1 + visits_[i]) / useful *
           visit_seconds(stimuli_, begun_ && there.plate != here.plate, begun_ && there.mounting != here.mounting,
                         contrasts);
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
