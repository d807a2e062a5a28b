// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/judgement/verdict_record.h"

#include <array>

#include "bench/judgement/demand_kinds.h"
#include "bench/text/json_reader.h"

namespace todbench {

namespace {

constexpr std::string_view schema = "todbench-verdict-1";
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

Json demand_json(const Demand& demand) {
  Json json;
  json["kind"] = to_string(demand.kind);
  json["delta_t_k"] = json_number(demand.delta_t_k);
  json["unit"] = row_of(demand.kind).unit;
  json["limit"] = json_number(demand.limit);
  json["result"] = json_number(demand.result);
  json["interval"] = json_interval(demand.interval);
  json["interval_percent"] = demand.interval_percent;
  if (demand.statistical) json["statistical_interval"] = json_interval(*demand.statistical);
  json["decision"] = to_string(demand.decision);
  json["reason"] = demand.reason;
  if (demand.zone) json["zone"] = *demand.zone;
  if (demand.ratio) json["ratio"] = to_string(*demand.ratio);
  if (demand.conformity) {
    json["conformity"] = {{"decision", to_string(*demand.conformity)},
                          {"p_conformity", json_number(demand.p_conformity)},
                          {"consumer_risk", json_number(demand.consumer_risk())},
                          {"producer_risk", json_number(demand.producer_risk())}};
    if (demand.degrees_of_freedom) json["conformity"]["degrees_of_freedom"] = json_number(demand.degrees_of_freedom);
  }
  if (const auto& fleet = demand.fleet) {
    json["fleet"] = {{"units", fleet->units},
                     {"p_conformity", json_number(fleet->p_conformity)},
                     {"consumer_risk", json_number(fleet->consumer_risk)},
                     {"producer_risk", json_number(fleet->producer_risk)},
                     {"consumer_risk_most", json_number(fleet->consumer_risk_most)},
                     {"producer_risk_most", json_number(fleet->producer_risk_most)}};
  }
  return json;
}

Demand demand_from(const JsonReader& reader) {
  Demand demand;
  demand.kind = reader.at("kind").named(known_kinds());
  demand.delta_t_k = reader.at("delta_t_k").optional_number();
  reader.at("unit").expect(row_of(demand.kind).unit);
  demand.limit = reader.at("limit").optional_number();
  demand.result = reader.at("result").optional_number();
  demand.interval = reader.at("interval").interval();
  demand.interval_percent = static_cast<int>(reader.at("interval_percent").whole());
  if (const JsonReader statistical = reader.at_if_there("statistical_interval"); !statistical.is_null())
    demand.statistical = statistical.interval();
  demand.decision = reader.at("decision").named(decisions);
  demand.reason = reader.at("reason").text();
  if (const JsonReader zone = reader.at_if_there("zone"); !zone.is_null()) demand.zone = zone.text();
  if (const JsonReader ratio = reader.at_if_there("ratio"); !ratio.is_null())
    demand.ratio = ratio.named(all_ratio_kinds);
  if (const JsonReader conformity = reader.at_if_there("conformity"); !conformity.is_null()) {
    demand.conformity = conformity.at("decision").named(conformity_decisions);
    demand.p_conformity = conformity.at("p_conformity").optional_number();
    if (const JsonReader freedom = conformity.at_if_there("degrees_of_freedom"); !freedom.is_null())
      demand.degrees_of_freedom = freedom.number();
  }
  if (const JsonReader fleet = reader.at_if_there("fleet"); !fleet.is_null()) {
    demand.fleet = DemandFleet{.units = static_cast<int>(fleet.at("units").whole()),
                               .p_conformity = fleet.at("p_conformity").number(),
                               .consumer_risk = fleet.at("consumer_risk").number(),
                               .producer_risk = fleet.at("producer_risk").number(),
                               .consumer_risk_most = fleet.at("consumer_risk_most").number(),
                               .producer_risk_most = fleet.at("producer_risk_most").number()};
  }
  return demand;
}

}  // namespace

Json verdict_json(const Verdict& verdict) {
  Json json;
  json["schema"] = schema;
  json["decision"] = to_string(verdict.decision);
  json["reason"] = verdict.reason;
  json["rule"] = to_string(verdict.rule);
  json["rule_in_words"] = verdict.rule_in_words;
  json["demands"] = Json::array();
  for (const Demand& demand : verdict.demands) json["demands"].push_back(demand_json(demand));
  json["ended_early"] = verdict.ended_early ? Json(*verdict.ended_early) : Json();
  json["judged"] = to_string(verdict.judged);
  if (verdict.not_stated) json["uncertainty_not_stated"] = *verdict.not_stated;
  return json;
}

Result<Verdict> verdict_from(const Json& record) {
  const JsonReader reader(record);
  reader.at("schema").expect(schema);
  Verdict verdict;
  verdict.decision = reader.at("decision").named(decisions);
  verdict.reason = reader.at("reason").text();
  verdict.rule = reader.at("rule").named(conformity_rules);
  verdict.rule_in_words = reader.at("rule_in_words").text();
  for (const JsonReader& demand : reader.at("demands").elements()) verdict.demands.push_back(demand_from(demand));
  const JsonReader ended_early = reader.at("ended_early");
  if (!ended_early.is_null()) verdict.ended_early = ended_early.text();
  verdict.judged = reader.at("judged").named(moments);
  if (const JsonReader not_stated = reader.at_if_there("uncertainty_not_stated"); !not_stated.is_null())
    verdict.not_stated = not_stated.texts();
  if (const Result<void> read = reader.finish(); !read) return tl::unexpected(read.error());
  return verdict;
}

}  // namespace todbench
