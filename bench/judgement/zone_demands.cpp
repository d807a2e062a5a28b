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
  std::string_view name, measure, words;
};
constexpr std::array zone_demands{
    ZoneDemand{DemandKind::zone_bad_pixels, &ZoneLimit::bad_pixels, "zone_bad_pixels", "bad_pixels", "bad pixels"},
    ZoneDemand{DemandKind::zone_substituted_pixels, &ZoneLimit::substituted_pixels, "zone_substituted_pixels",
               "substituted_pixels", "substituted pixels"},
    ZoneDemand{DemandKind::zone_clusters, &ZoneLimit::clusters, "zone_clusters", "defect_clusters",
               "clusters of defective pixels"},
    ZoneDemand{DemandKind::zone_largest_cluster, &ZoneLimit::largest_cluster, "zone_largest_cluster", "largest_cluster",
               "pixels in the largest cluster"},
};

const ZoneDemand& zone_demand_of(DemandKind kind) {
  const auto* const found = std::find_if(zone_demands.begin(), zone_demands.end(),
                                         [&](const ZoneDemand& demand) { return demand.kind == kind; });
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

template <DemandKind kind>
std::vector<Demand> judge_zones(const JudgementInput& evidence) {
  const ZoneDemand& asked = zone_demand_of(kind);
  std::vector<Demand> demands;
  for (const ZoneLimit& zone : evidence.limits.zones)
    if (const auto& limit = zone.*asked.limit) demands.push_back(judged_zone(asked, zone, *limit, evidence));
  return demands;
}

std::string zone_in_words(const Demand& demand) {
  const std::string limit = demand.limit ? number_text(*demand.limit) : "(no number)";
  return "at most " + limit + " " + std::string(zone_demand_of(demand.kind).words) + " in zone '" +
         demand.zone.value_or("") + "'";
}

template <DemandKind kind>
DemandKindRow row_of_zone() {
  return {kind, zone_demand_of(kind).name, "1", LimitSide::at_most, judge_zones<kind>, zone_in_words};
}

}  // namespace

DemandKindRow zone_row(DemandKind kind) {
  switch (kind) {
    case DemandKind::zone_bad_pixels:
      return row_of_zone<DemandKind::zone_bad_pixels>();
    case DemandKind::zone_substituted_pixels:
      return row_of_zone<DemandKind::zone_substituted_pixels>();
    case DemandKind::zone_clusters:
      return row_of_zone<DemandKind::zone_clusters>();
    default:
      break;
  }
  assert(kind == DemandKind::zone_largest_cluster);
  return row_of_zone<DemandKind::zone_largest_cluster>();
}

}  // namespace todbench
