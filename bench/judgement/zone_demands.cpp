// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/judgement/zone_demands.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "bench/judgement/limit_decision.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

struct ZoneDemand {
  DemandKind kind;
  std::optional<double> ZoneLimit::*limit;
  std::string_view measure, words;
};
constexpr std::array zone_demands{
    ZoneDemand{{"zone_bad_pixels"}, &ZoneLimit::bad_pixels, "bad_pixels", "bad pixels"},
    ZoneDemand{{"zone_substituted_pixels"}, &ZoneLimit::substituted_pixels, "substituted_pixels", "substituted pixels"},
    ZoneDemand{{"zone_clusters"}, &ZoneLimit::clusters, "defect_clusters", "clusters of defective pixels"},
    ZoneDemand{
        {"zone_largest_cluster"}, &ZoneLimit::largest_cluster, "largest_cluster", "pixels in the largest cluster"},
};

const ZoneDemand& zone_demand_of(const DemandKindRow& row) {
  const auto* const found = std::find_if(zone_demands.begin(), zone_demands.end(),
                                         [&](const ZoneDemand& demand) { return demand.kind == row.kind; });
  assert(found != zone_demands.end());
  return *found;
}

Demand judged_zone(const ZoneDemand& asked, const ZoneLimit& zone, double limit, const JudgementInput& evidence) {
  Demand demand{.kind = asked.kind, .limit = limit, .zone = zone.name};
  demand.conformity = ConformityDecision::inconclusive;
  const std::string name = std::string(asked.measure) + (zone.name == whole_frame_zone ? "" : " (" + zone.name + ")");
  const MeasuredQuantity* measured = quantity_of(evidence, name);
  if (measured == nullptr || !measured->value) {
    demand.reason = "this quantity was not measured";
    return demand;
  }
  demand.result = measured->value;
  demand.interval = measured->ci95;
  // Counts are exact. If part of the zone was not observed, the count is a lower bound.
  const LimitAnswer answer =
      decide({.value = demand.result, .interval = demand.interval, .limit = limit, .at_least = false},
             evidence.limits.rule, evidence.limits.guard_band_risk);
  demand.conformity = answer.decision;
  demand.p_conformity = answer.p_conformity;
  demand.decision = kind_of(answer.decision);
  demand.reason = "found " + number_text(*measured->value);
  if (!measured->ci95.high) demand.reason += " in the observed part of the zone";
  return demand;
}

std::vector<Demand> judge_zones(const DemandKindRow& row, const JudgementInput& evidence) {
  const ZoneDemand& asked = zone_demand_of(row);
  std::vector<Demand> demands;
  for (const ZoneLimit& zone : evidence.limits.zones)
    if (const auto& limit = zone.*asked.limit) demands.push_back(judged_zone(asked, zone, *limit, evidence));
  return demands;
}

std::string zone_in_words(const DemandKindRow& row, const Demand& demand) {
  const std::string limit = demand.limit ? number_text(*demand.limit) : "(no number)";
  return "at most " + limit + " " + std::string(zone_demand_of(row).words) + " in zone '" + demand.zone.value_or("") +
         "'";
}

}  // namespace

std::vector<DemandKindRow> zone_rows() {
  std::vector<DemandKindRow> rows;
  for (const ZoneDemand& demand : zone_demands)
    rows.push_back({demand.kind, "1", LimitSide::at_most, judge_zones, zone_in_words});
  return rows;
}

}  // namespace todbench
