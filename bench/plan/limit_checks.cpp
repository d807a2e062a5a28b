// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/limit_checks.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "acquisition/base/normal.h"
#include "bench/plan/quantity.h"
#include "bench/text/text.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

ValueMistakes check_zone_name(const Plan& plan, std::size_t row) {
  const std::string& name = plan.limits.zones[row].name;
  if (name.empty()) return {{std::nullopt, "a zone needs a name"}};
  for (std::size_t other = 0; other < row; ++other)
    if (plan.limits.zones[other].name == name) return {{std::nullopt, "zone '" + name + "' is listed twice"}};
  if (!plan.measures.pixels) return {{std::nullopt, "limits of a zone need pixels = true in [measures]"}};
  return {};
}

ValueMistakes check_zone_area(const Plan& plan, std::size_t row) {
  const ZoneLimit& zone = plan.limits.zones[row];
  if (zone.name == whole_frame_zone || zone.area.size() != 4) return {};
  const auto& a = zone.area;
  if (!(a[0] < a[2]) || !(a[1] < a[3]))
    return {{std::nullopt, "expected left < right and top < bottom, for example [0.25, 0.25, 0.75, 0.75]"}};
  for (std::size_t other = 0; other < row; ++other) {
    const ZoneLimit& before = plan.limits.zones[other];
    if (before.name == whole_frame_zone || before.area.size() != 4) continue;
    const auto& b = before.area;
    if (a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3])
      return {{std::nullopt, "zone '" + zone.name + "' overlaps zone '" + before.name + "'"}};
  }
  return {};
}

ValueMistakes check_zone_limits(const Plan& plan, std::size_t row) {
  const ZoneLimit& zone = plan.limits.zones[row];
  if (zone.bad_pixels || zone.substituted_pixels || zone.clusters || zone.largest_cluster) return {};
  return {{std::nullopt, "zone '" + zone.name + "' has no limit: state at least one, or remove the zone"}};
}

ValueMistakes check_limit_contrast(const Plan& plan, std::size_t row) {
  ValueMistakes mistakes;
  const double limit = plan.limits.acuity[row].delta_t_k;
  bool shown = false;
  for (const double contrast : plan.target.delta_t_k) shown = shown || same_contrast(limit, contrast);
  if (plan.schedule.kind == ScheduleKind::ramp && plan.schedule.from_delta_t_k && plan.schedule.to_delta_t_k) {
    const double to = *plan.schedule.to_delta_t_k;
    shown = shown || (limit / to >= 1 && limit / to <= *plan.schedule.from_delta_t_k / to);
  }
  if (!shown) mistakes.push_back({std::nullopt, number_text(limit) + " K is not among the contrasts of [target]"});
  for (std::size_t other = 0; other < row; ++other) {
    if (same_contrast(limit, plan.limits.acuity[other].delta_t_k))
      mistakes.push_back({std::nullopt, "a second limit at " + number_text(limit) + " K"});
  }
  return mistakes;
}

ValueMistakes check_margin(const Plan& plan, std::size_t /*row*/) {
  const auto& margin = plan.limits.equivalence_margin_percent;
  if (!margin || plan.limits.rule == ConformityRule::simple) return {};
  // Two one-sided tests at 5 %. Contrast rows are left out because the slope of the curve is not known yet.
  const double stated = known_u_of_acuity(plan, BudgetCommon::twin);
  if (1.645 * stated < std::log1p(*margin / 100)) return {};
  return {{std::nullopt, "no unit can pass: the budget alone gives a ratio of acuities an uncertainty of " +
                             number_text(std::round(16450 * stated) / 100) + " % (90 %), but the margin is " +
                             number_text(*margin) + " %"}};
}

ValueMistakes check_limited_measure(const Plan& plan, std::size_t row) {
  const std::string& name = plan.limits.measures[row].measure;
  const Quantity* quantity = find_limited_quantity(name);
  if (quantity == nullptr) return {};
  ValueMistakes mistakes;
  for (const std::string_view needed : {quantity->measure, quantity->second_measure}) {
    for (const MeasureKey& key : measure_keys) {
      if (key.name == needed && !(plan.measures.*key.requested))
        mistakes.push_back(
            {std::nullopt, "a limit on " + name + " needs " + std::string(needed) + " = true in [measures]"});
    }
  }
  for (std::size_t other = 0; other < row; ++other) {
    if (plan.limits.measures[other].measure == name) mistakes.push_back({std::nullopt, "a second row for " + name});
  }
  return mistakes;
}

ValueMistakes check_fleet_measure(const Plan& plan, std::size_t row) {
  const FleetRow& fleet = plan.limits.fleets[row];
  const bool acuity = fleet.measure == fleet_acuity;
  if (!acuity && find_limited_quantity(fleet.measure) == nullptr)
    return {
        {std::nullopt, "expected acuity or a measure that can have a limit, found '" + one_line(fleet.measure) + "'"}};
  if (acuity && !fleet.delta_t_k) return {{std::nullopt, "a fleet of acuities needs delta_t_k"}};
  for (std::size_t other = 0; other < row; ++other) {
    const FleetRow& earlier = plan.limits.fleets[other];
    if (earlier.measure != fleet.measure) continue;
    if (!acuity || (earlier.delta_t_k && same_contrast(*earlier.delta_t_k, *fleet.delta_t_k)))
      return {{std::nullopt, "a second row for " + fleet.measure}};
  }
  return {};
}

ValueMistakes check_measure_limits(const Plan& plan, std::size_t row) {
  const MeasureLimit& limits = plan.limits.measures[row];
  const std::string& name = limits.measure;
  const Quantity* quantity = find_limited_quantity(name);
  if (quantity == nullptr) return {};
  if (!limits.at_least && !limits.at_most) return {{std::nullopt, name + " has no limit: state at_least or at_most"}};
  if (limits.at_least && !quantity->at_least.possible())
    return {{std::nullopt, name + " has no lower limit, only an upper one"}};
  if (limits.at_most && !quantity->at_most.possible())
    return {{std::nullopt, name + " has no upper limit, only a lower one"}};
  if (!limits.at_least || !limits.at_most) return {};
  if (*limits.at_least >= *limits.at_most)
    return {{std::nullopt, "no unit can pass: the lower limit of " + name + " is not below the upper limit"}};
  if (plan.limits.rule == ConformityRule::simple) return {};
  const double expanded = normal_z95 * relative_u(plan, quantity->stated) * 0.5 * (*limits.at_least + *limits.at_most);
  if (2 * expanded < *limits.at_most - *limits.at_least) return {};
  return {{std::nullopt, "no unit can pass: the budget alone gives " + name + " an expanded uncertainty of " +
                             number_text(std::round(1e6 * expanded) / 1e6) + ", but the tolerance is " +
                             number_text(std::round(1e6 * (*limits.at_most - *limits.at_least)) / 1e6)}};
}

ValueMistakes check_require(const Plan& plan, std::size_t /*row*/) {
  if (!plan.uncertainty.require) return {};
  std::string missing;
  for (const BudgetInput input : not_stated(budget_with_collimator(plan, {}))) {
    // The run adds this row itself.
    if (input == BudgetInput::air_path && plan.target.air_humidity_percent > 0 && plan.target.kind != TargetKind::scene)
      continue;
    missing += (missing.empty() ? "" : ", ") + std::string(to_string(input));
  }
  if (missing.empty()) return {};
  return {{std::nullopt, "the budget must be complete, but it does not state " + missing}};
}

ValueMistakes check_budget_name(const Plan& plan, std::size_t row) {
  const std::string& name = plan.uncertainty.rows[row].name;
  for (const std::string_view own : {finite_trials_row, seen_contrast_row, contrast_lag_row, read_back_row}) {
    if (name == own) return {{std::nullopt, "the run itself adds the row \"" + name + "\": use another name"}};
  }
  for (std::size_t other = 0; other < row; ++other) {
    if (plan.uncertainty.rows[other].name == name)
      return {{std::nullopt, "row '" + one_line(name) + "' is listed twice"}};
  }
  return {};
}

ValueMistakes check_budget_unit(const Plan& plan, std::size_t row) {
  const BudgetRow& stated = plan.uncertainty.rows[row];
  const BudgetInput input = input_of(stated);
  if (stated.sensitivity) return {};
  const std::string of = "row '" + one_line(stated.name) + "' enters " + std::string(to_string(input));
  const auto unit = budget_unit(kind_of(input), stated.unit);
  if (!unit) {
    return {{std::nullopt, of + ": expected " +
                               (kind_of(input) == InputKind::geometry   ? "\"mm\", \"%\" or \"1\""
                                : kind_of(input) == InputKind::contrast ? "\"K\", \"mK\", \"%\" or \"1\""
                                                                        : "\"%\" or \"1\"") +
                               ", or a sensitivity, found \"" + one_line(stated.unit) + "\""}};
  }
  if (!unit->relative && input == BudgetInput::ifov)
    return {{std::nullopt, of + ": expected \"%\" or \"1\", found \"" + one_line(stated.unit) + "\""}};
  return {};
}

ValueMistakes check_coverage_factor(const Plan& plan, std::size_t row) {
  const BudgetRow& stated = plan.uncertainty.rows[row];
  if (stated.coverage_factor == 1 || stated.distribution == BudgetDistribution::normal) return {};
  return {{std::nullopt, "row '" + one_line(stated.name) + "': only a normal distribution has a coverage factor"}};
}

}  // namespace todbench
