// SPDX-License-Identifier: GPL-3.0-or-later
// JSON and CSV of an evaluated comparison.
#include "bench/round_robin/round_robin_output.h"
#include "bench/text/spreadsheet.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

Json consensus_json(const Consensus& consensus) {
  return {{"value", json_number(consensus.value)}, {"u", json_number(consensus.u)}};
}

Json scatter_json(const RandomEffects& effects, double sd) {
  return {{"value", json_number(effects.mean.value)},
          {"u", json_number(effects.hartung_knapp)},
          {"between_laboratory_sd", json_number(sd)}};
}

Json check_json(const ConsistencyCheck& check) {
  return {{"chi2", json_number(check.chi2)},
          {"degrees_of_freedom", check.degrees_of_freedom},
          {"p", json_number(check.p)},
          {"birge_ratio", json_number(check.birge_ratio)},
          {"consistent", check.consistent()}};
}

Json degree_json(const DegreeOfEquivalence& degree) {
  return {{"laboratory", degree.result.laboratory},
          {"value", json_number(degree.result.value)},
          {"u", json_number(degree.result.u)},
          {"difference", json_number(degree.difference)},
          {"difference_expanded_u", json_number(degree.expanded_u)},
          {"e_n", json_number(degree.e_n)},
          {"zeta", json_number(degree.zeta)},
          {"in_reference", degree.in_reference},
          {"outlying", degree.outlying}};
}

Json truth_json(const TruthCheck& check) {
  return {{"value", json_number(check.truth.value)},
          {"u", json_number(check.truth.u)},
          {"reference_difference", json_number(check.difference)},
          {"reference_e_n", json_number(check.e_n)},
          {"reference_holds_truth", check.held}};
}

Json item_json(const ItemComparison& item) {
  Json results = Json::array();
  for (const DegreeOfEquivalence& degree : item.degrees) results.push_back(degree_json(degree));
  Json subset = consensus_json(item.consistent_subset);
  subset["laboratories"] = item.consistent_laboratories;
  return {{"item", item.item.item},
          {"quantity", item.item.quantity},
          {"unit", item.item.unit},
          {"reference",
           {{"method", to_string(item.reference.method)},
            {"value", json_number(item.reference.value.value)},
            {"u", json_number(item.reference.value.u)},
            {"k", json_number(item.reference.k)},
            {"expanded_u", json_number(item.reference.expanded_u)}}},
          {"consistency", check_json(item.all)},
          {"consistency_without_outlying", check_json(item.kept)},
          {"estimates",
           {{"weighted_mean", consensus_json(item.weighted)},
            {"median", consensus_json(item.median)},
            {"largest_consistent_subset", std::move(subset)},
            {"dersimonian_laird", scatter_json(item.dersimonian_laird, item.dersimonian_laird_sd)},
            {"paule_mandel", scatter_json(item.paule_mandel, item.paule_mandel_sd)}}},
          {"results", std::move(results)}};
}

}  // namespace

std::string_view verdict_word(const RoundRobin& found) {
  if (!found.outlying.empty()) return "outlying";
  return found.consistent() ? "consistent" : "inconsistent";
}

Json round_robin_json(const RoundRobin& found, const std::vector<TruthCheck>& truths) {
  Json items = Json::array(), laboratories = Json::array(), outlying = Json::array();
  for (std::size_t j = 0; j < found.items.size(); ++j) {
    items.push_back(item_json(found.items[j]));
    items.back()["truth"] = truths.empty() ? Json(nullptr) : truth_json(truths[j]);
  }
  for (const LaboratorySummary& laboratory : found.laboratories) {
    laboratories.push_back({{"laboratory", laboratory.laboratory},
                            {"items", laboratory.items},
                            {"combined_zeta", json_number(laboratory.combined_zeta)},
                            {"p", json_number(laboratory.p)},
                            {"outlying", laboratory.outlying}});
  }
  for (const OutlyingResult& one : found.outlying) {
    outlying.push_back({{"laboratory", one.laboratory},
                        {"item", one.item.empty() ? Json(nullptr) : Json(one.item)},
                        {"quantity", one.item.empty() ? Json(nullptr) : Json(one.quantity)},
                        {"zeta", json_number(one.zeta)},
                        {"p", json_number(one.p)}});
  }
  return {{"items", std::move(items)},
          {"laboratories", std::move(laboratories)},
          {"outlying", std::move(outlying)},
          {"outlying_significance", outlying_significance},
          {"consistency_significance", comparison_significance},
          {"verdict", verdict_word(found)}};
}

std::string round_robin_csv(const RoundRobin& found) {
  std::string out =
      "item,quantity,unit,laboratory,value,u,reference,reference_expanded_u,difference,difference_expanded_u,e_n,zeta,"
      "in_reference,outlying\n";
  for (const ItemComparison& item : found.items) {
    for (const DegreeOfEquivalence& degree : item.degrees) {
      for (const std::string& text : {item.item.item, item.item.quantity, item.item.unit, degree.result.laboratory})
        out += spreadsheet_field(text) + ",";
      for (const double number :
           {degree.result.value, degree.result.u, item.reference.value.value, item.reference.expanded_u,
            degree.difference, degree.expanded_u, degree.e_n, degree.zeta})
        out += number_text(number) + ",";
      out += std::string(degree.in_reference ? "yes" : "no") + "," + (degree.outlying ? "yes" : "no") + "\n";
    }
  }
  return out;
}

}  // namespace todbench
