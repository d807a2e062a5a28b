// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/judgement/verdict_record.h"

#include <array>

#include "bench/judgement/demand_kinds.h"
#include "bench/text/json_fields.h"

namespace todbench {

namespace {

constexpr std::array decisions{VerdictKind::pass, VerdictKind::fail, VerdictKind::inconclusive};
constexpr std::array conformity_decisions{ConformityDecision::pass, ConformityDecision::conditional_pass,
                                          ConformityDecision::inconclusive, ConformityDecision::conditional_fail,
                                          ConformityDecision::fail};
constexpr std::array moments{JudgedWhen::at_end_of_run, JudgedWhen::afterwards};

std::vector<DemandKind> known_kinds() {
  std::vector<DemandKind> kinds;
  for (const DemandKindRow& row : demand_kinds()) kinds.push_back(row.kind);
  return kinds;
}

void conformity_fields(JsonFields& json, Demand& demand) {
  json.value("decision", demand.conformity, conformity_decisions);
  json.value("p_conformity", demand.p_conformity);
  json.derived("consumer_risk", json_number(demand.consumer_risk()));
  json.derived("producer_risk", json_number(demand.producer_risk()));
  json.if_any("degrees_of_freedom", demand.degrees_of_freedom);
}

void fleet_fields(JsonFields& json, DemandFleet& fleet) {
  json.value("units", fleet.units);
  json.value("p_conformity", fleet.p_conformity);
  json.value("consumer_risk", fleet.consumer_risk);
  json.value("producer_risk", fleet.producer_risk);
  json.value("consumer_risk_most", fleet.consumer_risk_most);
  json.value("producer_risk_most", fleet.producer_risk_most);
}

void demand_fields(JsonFields& json, Demand& demand) {
  json.value("kind", demand.kind, known_kinds());
  json.value("delta_t_k", demand.delta_t_k);
  json.constant("unit", row_of(demand.kind).unit);
  json.value("limit", demand.limit);
  json.value("result", demand.result);
  json.value("interval", demand.interval);
  json.value("interval_percent", demand.interval_percent);
  json.if_any("statistical_interval", demand.statistical);
  json.value("decision", demand.decision, decisions);
  json.value("reason", demand.reason);
  json.if_any("zone", demand.zone);
  json.if_any("ratio", demand.ratio, all_ratio_kinds);
  json.part_if(demand.conformity.has_value(), "conformity", demand, conformity_fields);
  json.if_any("fleet", demand.fleet, fleet_fields);
}

void verdict_fields(JsonFields& json, Verdict& verdict) {
  json.constant("schema", "todbench-verdict-1");
  json.value("decision", verdict.decision, decisions);
  json.value("reason", verdict.reason);
  json.value("rule", verdict.rule, conformity_rules);
  json.value("rule_in_words", verdict.rule_in_words);
  json.value("demands", verdict.demands, demand_fields);
  json.value("ended_early", verdict.ended_early);
  json.value("judged", verdict.judged, moments);
  json.if_any("uncertainty_not_stated", verdict.not_stated);
}

}  // namespace

Json verdict_json(const Verdict& verdict) {
  return printed_json(verdict, verdict_fields);
}

Result<Json> verdict_record(const Verdict& verdict) {
  return json_of(verdict, verdict_fields);
}

Result<Verdict> verdict_from(const Json& record) {
  return from_json<Verdict>(record, verdict_fields);
}

}  // namespace todbench
