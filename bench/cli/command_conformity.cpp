// SPDX-License-Identifier: GPL-3.0-or-later
// todbench conformity, todbench budget
#include <algorithm>
#include <map>
#include <memory>
#include <optional>

#include "bench/cli/commands.h"
#include "bench/judgement/conformity.h"
#include "bench/judgement/uncertainty_budget.h"
#include "bench/judgement/verdict.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

struct ConformityArguments {
  MeasuredValue measured;
  ToleranceLimits tolerance;
  std::string rule{to_string(ConformityRule::guarded_acceptance_and_rejection)};
  std::optional<double> coverage_factor, guard_band, risk, fleet_mean, fleet_sd;
};

/// Other names of the rules.
const std::map<std::string, std::string> rule_names{{"guarded_acceptance", "guarded"},
                                                    {"guarded_both", "guarded_acceptance_and_rejection"}};

ConformityRule rule_of(const std::string& name) {
  for (const ConformityRule rule : conformity_rules) {
    if (to_string(rule) == name) return rule;
  }
  return ConformityRule::guarded_acceptance_and_rejection;
}

double guard_band_of(const ConformityArguments& a) {
  if (a.guard_band) return *a.guard_band;
  if (a.risk) return guard_band_for_risk(*a.risk, a.measured);
  if (a.coverage_factor) return *a.coverage_factor * a.measured.u;
  return usual_guard_band(a.measured);
}

int exit_code_of(ConformityDecision decision) {
  if (decision == ConformityDecision::pass) return exit_code(VerdictKind::pass);
  return exit_code(decision == ConformityDecision::fail ? VerdictKind::fail : VerdictKind::inconclusive);
}

Json limits_json(const ToleranceLimits& limits) {
  return {json_number(limits.at_least), json_number(limits.at_most)};
}

Json conformity_json(const ConformityArguments& a, const Conformity& found, const std::optional<GlobalRisks>& risks) {
  Json json{{"value", a.measured.value},
            {"u", a.measured.u},
            {"tolerance_limits", limits_json(a.tolerance)},
            {"rule", a.rule},
            {"p_conformity", json_number(found.p_conformity)},
            {"p_nonconformity", json_number(found.p_nonconformity)},
            {"decision", to_string(found.decision)},
            {"guard_band", json_number(found.guard_band)},
            {"acceptance_limits", limits_json(found.acceptance)},
            {"acceptance_zone_is_empty", found.acceptance_zone_is_empty}};
  if (risks) {
    json["consumer_risk"] = json_number(risks->consumer_risk);
    json["producer_risk"] = json_number(risks->producer_risk);
    json["global_risks"] = {{"p_conforming", json_number(risks->p_conforming)},
                            {"p_accepted", json_number(risks->p_accepted)},
                            {"consumer_risk", json_number(risks->consumer_risk)},
                            {"producer_risk", json_number(risks->producer_risk)},
                            {"p_nonconforming_if_accepted", json_number(risks->p_nonconforming_if_accepted)}};
  }
  return json;
}

void print_conformity(Console& console, const ConformityArguments& a, const Conformity& found,
                      const std::optional<GlobalRisks>& risks) {
  std::vector<TableRow> rows{{"decision", std::string(to_string(found.decision)) + " (" + a.rule + ")"},
                             {"probability of conformity", fixed(found.p_conformity, 4)},
                             {"guard band", number_text(found.guard_band)},
                             {"acceptance limits", range({found.acceptance.at_least, found.acceptance.at_most}, 6)}};
  if (risks) {
    rows.push_back({"consumer's risk over the fleet", fixed(risks->consumer_risk, 5)});
    rows.push_back({"producer's risk over the fleet", fixed(risks->producer_risk, 5)});
  }
  console.table({"quantity", "value"}, rows);
}

int run_conformity(Console& console, const ConformityArguments& a) {
  if (a.fleet_mean.has_value() != a.fleet_sd.has_value())
    return report_error(console, {ErrorCode::invalid_input, "--fleet-mean and --fleet-sd must be given together"});
  const auto found = conformity(a.measured, a.tolerance, rule_of(a.rule), guard_band_of(a));
  if (!found) return report_error(console, with_context("conformity", found.error()));
  std::optional<GlobalRisks> risks;
  if (a.fleet_sd) {
    const auto computed = global_risks({*a.fleet_mean, *a.fleet_sd}, {a.measured.u, a.measured.degrees_of_freedom},
                                       a.tolerance, found->acceptance);
    if (!computed) return report_error(console, with_context("conformity", computed.error()));
    risks = *computed;
  }
  if (found->acceptance_zone_is_empty) {
    console.note("no value can pass, because twice the guard band of " + number_text(found->guard_band) +
                 " is wider than the tolerance; widen the limits or reduce the guard band");
  }
  if (console.json())
    console.object(conformity_json(a, *found, risks));
  else
    print_conformity(console, a, *found, risks);
  return exit_code_of(found->decision);
}

Json row_json(const BudgetRow& row, const BudgetShare& share) {
  Json commons = Json::array();
  for (const BudgetCommon common : row.common) commons.push_back(to_string(common));
  return {{"name", row.name},
          {"value", row.value},
          {"unit", row.unit},
          {"distribution", to_string(row.distribution)},
          {"coverage_factor", row.coverage_factor},
          {"degrees_of_freedom", json_number(row.degrees_of_freedom)},
          {"sensitivity", row.sensitivity.value_or(1)},
          {"standard_uncertainty", json_number(share.standard_uncertainty)},
          {"contribution", json_number(share.contribution)},
          {"share_percent", json_number(share.share_percent)},
          {"source", row.source},
          {"certificate", row.certificate},
          {"common", commons}};
}

Json budget_json(const UncertaintyBudget& budget, const CombinedUncertainty& combined) {
  Json rows = Json::array();
  for (std::size_t i = 0; i < budget.rows.size(); ++i) rows.push_back(row_json(budget.rows[i], combined.shares[i]));
  return {{"quantity", budget.quantity},
          {"unit", budget.unit},
          {"u", json_number(combined.u)},
          {"nu_eff", json_number(combined.nu_eff)},
          {"k", json_number(combined.k)},
          {"expanded_gum", json_number(combined.expanded_gum)},
          {"expanded_monte_carlo", json_number(combined.expanded_monte_carlo)},
          {"expanded", json_number(combined.expanded)},
          {"rows", rows}};
}

void print_budget(Console& console, const UncertaintyBudget& budget, const CombinedUncertainty& combined) {
  std::vector<TableRow> rows;
  for (std::size_t i = 0; i < budget.rows.size(); ++i) {
    const BudgetRow& row = budget.rows[i];
    const BudgetShare& share = combined.shares[i];
    rows.push_back({row.name, number_text(row.value), std::string(to_string(row.distribution)),
                    row.degrees_of_freedom ? fixed(row.degrees_of_freedom, 0) : "infinite",
                    number_text(row.sensitivity.value_or(1)), fixed(share.contribution, 6),
                    fixed(share.share_percent, 1)});
  }
  console.table({"row", "value", "distribution", "degrees of freedom", "sensitivity", "contribution", "% of variance"},
                rows);
  console.text("");
  const std::string unit = budget.unit.empty() ? "" : " " + budget.unit;
  console.table({"quantity", "value"},
                {{"standard uncertainty", fixed(combined.u, 6) + unit},
                 {"effective degrees of freedom", combined.nu_eff ? fixed(combined.nu_eff, 1) : "infinite"},
                 {"coverage factor, 95 %", fixed(combined.k, 4)},
                 {"expanded, GUM", fixed(combined.expanded_gum, 6) + unit},
                 {"expanded, Monte Carlo", fixed(combined.expanded_monte_carlo, 6) + unit},
                 {"expanded, larger of both", fixed(combined.expanded, 6) + unit}});
}

int run_budget(Console& console, const std::string& file, std::uint64_t seed) {
  const auto budget = read_budget(file);
  if (!budget) return report_error(console, budget.error());
  const auto result = combined(*budget, seed);
  if (!result) return report_error(console, with_context(file, result.error()));
  if (console.json())
    console.object(budget_json(*budget, *result));
  else
    print_budget(console, *budget, *result);
  return 0;
}

}  // namespace

void add_conformity_command(CLI::App& app, Program& program) {
  auto* command =
      app.add_subcommand("conformity", "judges a value with its uncertainty against tolerance limits, by a named rule");
  auto a = std::make_shared<ConformityArguments>();
  constexpr double most = 1e100;
  command->add_option("--value", a->measured.value, "measured value")->required()->check(number_in(-most, most));
  command->add_option("--u", a->measured.u, "standard uncertainty of the value")->required()->check(number_in(0, most));
  command
      ->add_option("--nu", a->measured.degrees_of_freedom, "degrees of freedom of the uncertainty; default: infinite")
      ->check(number_in(1, most));
  command->add_option("--at-least", a->tolerance.at_least, "lower tolerance limit")->check(number_in(-most, most));
  command->add_option("--at-most", a->tolerance.at_most, "upper tolerance limit")->check(number_in(-most, most));
  std::vector<std::string> names;
  for (const ConformityRule rule : conformity_rules) names.emplace_back(to_string(rule));
  for (const auto& [name, meant] : rule_names) names.push_back(name);
  command
      ->add_option("--rule", a->rule, "decision rule: simple, guarded, non_binary or guarded_acceptance_and_rejection")
      ->check(CLI::IsMember(names))
      ->capture_default_str();
  auto* band = command->add_option("--guard-band", a->guard_band, "guard band in the unit of the value")
                   ->check(number_in(0, most));
  auto* risk = command
                   ->add_option("--guard-band-risk", a->risk,
                                "sets the guard band from this risk of a wrong acceptance at the acceptance limit")
                   ->check(number_in(1e-9, 0.5))
                   ->excludes(band);
  command
      ->add_option("--coverage-factor", a->coverage_factor,
                   "guard band in standard uncertainties; default: 2, or with --nu the factor of Student's t with the "
                   "same risk")
      ->check(number_in(0, 1e6))
      ->excludes(band)
      ->excludes(risk);
  command
      ->add_option("--fleet-mean", a->fleet_mean,
                   "mean of the true values of the fleet; with --fleet-sd, adds the global risks")
      ->check(number_in(-most, most));
  command->add_option("--fleet-sd", a->fleet_sd, "standard deviation of the true values of the fleet")
      ->check(number_in(0, most));
  finish_command(*command, program, [a](Console& console) {
    if (const auto known = rule_names.find(a->rule); known != rule_names.end()) a->rule = known->second;
    return run_conformity(console, *a);
  });
}

void add_budget_command(CLI::App& app, Program& program) {
  auto* command =
      app.add_subcommand("budget", "combines the rows of an uncertainty budget, by the GUM and by Monte Carlo");
  auto file = std::make_shared<std::string>();
  command->add_option("BUDGET.toml", *file, "file with [[component]] tables")->required();
  finish_command(*command, program,
                 [file, &program](Console& console) { return run_budget(console, *file, program.common.seed); });
}

}  // namespace todbench
