// SPDX-License-Identifier: GPL-3.0-or-later
// Plan keys of limits, fleet and budget.
#include "bench/plan/plan_sections.h"

#include "bench/plan/key_places.h"
#include "bench/plan/limit_checks.h"
#include "bench/plan/quantity.h"

namespace todbench {

namespace {

/// Words for distributions: names and the alternatives that a budget may use.
const std::vector<std::string>& distribution_words() {
  static const std::vector<std::string> words = [] {
    std::vector<std::string> all = names_of(budget_distributions);
    for (const BudgetDistribution distribution : budget_distributions) {
      if (distribution != BudgetDistribution::normal)
        all.push_back(std::string(to_string(distribution)) + " half-width");
    }
    return all;
  }();
  return words;
}

/// "rectangular half-width" means "rectangular".
KeyPlace distribution_place() {
  return {
      .get = [](const Plan& plan, std::size_t row) { return to_key_value(plan.uncertainty.rows[row].distribution); },
      .set =
          [](Plan& plan, std::size_t row, const KeyValue& value) {
            const auto& word = std::get<std::string>(value);
            plan.uncertainty.rows[row].distribution = value_named<BudgetDistribution>(word.substr(0, word.find(' ')));
          }};
}

}  // namespace

PlanSection limits_section() {
  return {
      .name = "limits",
      .sentence = "Demands on the result, and the decision rule.",
      .keys = {
          {.name = "equivalence_margin_percent",
           .type = OptionalNumberKey{NumberRange::above_to(0, 100)},
           .unit = "%",
           .sentence = "Equivalence margin for the ratio of camera to twin. By default equivalence is not demanded",
           .place = in(&Plan::limits, &LimitsPlan::equivalence_margin_percent),
           .form = {"Equivalence margin", "planMargin"},
           .check = check_margin},
          {.name = "rule",
           .type = ChoiceKey{names_of(conformity_rules)},
           .sentence =
               "Decision rule for an interval and a limit. Agree on it before the measurement (method/conformity.md)",
           .place = in(&Plan::limits, &LimitsPlan::rule),
           .written_at_default = false},
          {.name = "guard_band_risk",
           .type = OptionalNumberKey{NumberRange::between(1e-9, 0.5)},
           .sentence =
               "Risk of a wrong acceptance at the acceptance limit. By default the guard band is the 95 % interval",
           .place = in(&Plan::limits, &LimitsPlan::guard_band_risk)},
          {.name = "fleet_sd_percent",
           .type = OptionalNumberKey{NumberRange::above_to(0, 100)},
           .unit = "%",
           .sentence = "Standard deviation of the true acuities of the fleet. If it is stated, todbench plan reports "
                       "the risks of both sides",
           .place = in(&Plan::limits, &LimitsPlan::fleet_sd_percent)}}};
}

PlanSection acuity_limits_section() {
  const auto rows = [](auto& plan) -> auto& {
    return plan.limits.acuity;
  };
  return {.name = "limits.acuity",
          .sentence = "The smallest 75 % acuity that is accepted at a contrast.",
          .keys = {{.name = "delta_t_k",
                    .type = NumberKey{NumberRange::between(-500, 500)},
                    .unit = "K",
                    .sentence = "Contrast, one of those of [target]",
                    .place = in_row(rows, &AcuityLimit::delta_t_k),
                    .required = Required::always,
                    .check = check_limit_contrast},
                   {.name = "least_acuity_per_mrad",
                    .type = NumberKey{NumberRange::between(1e-6, 1e6)},
                    .unit = "1/mrad",
                    .sentence = "Acuity that the unit must reach at this contrast",
                    .place = in_row(rows, &AcuityLimit::least_acuity_per_mrad),
                    .required = Required::always}},
          .rows = rows_of(rows),
          .form = {"Minimum acuity", "planLimits", "target.delta_t_k"}};
}

PlanSection measure_limits_section() {
  const auto rows = [](auto& plan) -> auto& {
    return plan.limits.measures;
  };
  return {.name = "limits.measure",
          .sentence =
              "Limits on a physical measure of [measures], in its unit (K; K/K for transfer_slope, 1 for MTF and CTF).",
          .keys = {{.name = "measure",
                    .type = ChoiceKey{limited_quantity_names()},
                    .sentence = "Name of the measure, as in measures.json",
                    .place = in_row(rows, &MeasureLimit::measure),
                    .required = Required::always,
                    .check = check_limited_measure},
                   {.name = "at_least",
                    .type = OptionalNumberKey{positive},
                    .sentence = "Lower limit. Quantities that are better when smaller, such as noise, have none",
                    .place = in_row(rows, &MeasureLimit::at_least)},
                   {.name = "at_most",
                    .type = OptionalNumberKey{positive},
                    .sentence = "Upper limit. MTF and CTF have none",
                    .place = in_row(rows, &MeasureLimit::at_most),
                    .check = check_measure_limits}},
          .rows = rows_of(rows),
          .form = {"Limits on measures", "planMeasureLimits"}};
}

PlanSection zone_limits_section() {
  const auto rows = [](auto& plan) -> auto& {
    return plan.limits.zones;
  };
  const auto most = [rows](std::string_view name, std::string_view sentence, std::optional<double> ZoneLimit::*member) {
    return PlanKey{
        .name = name, .type = OptionalNumberKey{not_negative}, .sentence = sentence, .place = in_row(rows, member)};
  };
  PlanSection section{
      .name = "limits.zone",
      .sentence =
          "Largest numbers of bad and substituted pixels in a part of the frame. Zones must not overlap, except "
          "'whole'.",
      .keys = {{.name = "name",
                .type = TextKey{},
                .sentence = "Name of the zone. 'whole' is the whole frame, regardless of its area",
                .place = in_row(rows, &ZoneLimit::name),
                .required = Required::always,
                .check = check_zone_name},
               {.name = "area",
                .type = NumbersKey{share, "four numbers: left, top, right, bottom", 4},
                .sentence = "Area of the zone, in fractions of the frame",
                .place = in_row(rows, &ZoneLimit::area),
                .check = check_zone_area},
               most("bad_pixels", "Largest number of bad pixels: stuck, dead, hot, noisy or blinking",
                    &ZoneLimit::bad_pixels),
               most("substituted_pixels", "Largest number of pixels that the camera has replaced by their neighbours",
                    &ZoneLimit::substituted_pixels),
               most("clusters", "Largest number of clusters of at least two touching bad or substituted pixels",
                    &ZoneLimit::clusters),
               most("largest_cluster", "Largest number of pixels in a cluster", &ZoneLimit::largest_cluster)},
      .rows = rows_of(rows),
      .form = {"Limits on pixels by zone", "planZoneLimits"}};
  section.keys.back().check = check_zone_limits;
  return section;
}

PlanSection fleet_section() {
  const auto rows = [](auto& plan) -> auto& {
    return plan.limits.fleets;
  };
  return {
      .name = "limits.fleet",
      .sentence =
          "Distribution of a measure over earlier units of this kind, as `todbench history prior` writes it. With it, "
          "the verdict states global risks.",
      .keys =
          {{.name = "measure",
            .type = TextKey{},
            .sentence = "Measure: acuity, or a physical measure that can have a limit",
            .place = in_row(rows, &FleetRow::measure),
            .required = Required::always,
            .check = check_fleet_measure},
           {.name = "delta_t_k",
            .type = OptionalNumberKey{NumberRange::between(-500, 500)},
            .unit = "K",
            .sentence = "Set contrast of an acuity",
            .place = in_row(rows, &FleetRow::delta_t_k)},
           {.name = "mean",
            .type = NumberKey{positive},
            .sentence = "Mean of the true values, in the unit of the measure. For an acuity, the geometric mean",
            .place = in_row(rows, &FleetRow::mean),
            .required = Required::always},
           {.name = "sd",
            .type = NumberKey{positive},
            .sentence =
                "Standard deviation of the true values, in the unit of the measure. For an acuity, that of ln acuity",
            .place = in_row(rows, &FleetRow::sd),
            .required = Required::always},
           {.name = "u",
            .type = NumberKey{not_negative},
            .sentence = "Standard uncertainty of one of these values, on the scale of sd",
            .place = in_row(rows, &FleetRow::u)},
           {.name = "units",
            .type = WholeKey{least_fleet_units, 1000000},
            .sentence = "Number of units",
            .place = in_row(rows, &FleetRow::units),
            .required = Required::always},
           {.name = "source",
            .type = TextKey{},
            .sentence = "Source of the values, in free text",
            .place = in_row(rows, &FleetRow::source)}},
      .rows = rows_of(rows),
      .form = {"Earlier units of the fleet", "planFleets"}};
}

PlanSection uncertainty_section() {
  return {.name = "uncertainty",
          .sentence =
              "The budget: uncertainties that the interval of the trials does not contain. A plan with rows is judged "
              "by the expanded interval.",
          .keys = {{.name = "require",
                    .type = FlagKey{},
                    .sentence = "Reject a plan whose budget lacks an expected row",
                    .place = in(&Plan::uncertainty, &UncertaintyPlan::require),
                    .check = check_require,
                    .written_at_default = false}}};
}

PlanSection budget_row_section() {
  const auto rows = [](auto& plan) -> auto& {
    return plan.uncertainty.rows;
  };
  const auto of = [rows](auto member) { return in_row(rows, member); };
  return {
      .name = "uncertainty.component",
      .sentence = "A row of the budget, as in the file of `todbench budget`.",
      .keys =
          {{.name = "name",
            .type = TextKey{},
            .sentence = "Name of the uncertain quantity",
            .place = of(&BudgetRow::name),
            .required = Required::always,
            .check = check_budget_name},
           {.name = "value",
            .type = NumberKey{not_negative},
            .sentence =
                "Standard uncertainty, half-width or amplitude, depending on the distribution; 0: known exactly",
            .place = of(&BudgetRow::value),
            .required = Required::always},
           {.name = "unit",
            .type = TextKey{},
            .sentence =
                "Unit of the value: m, cm, mm or um for lengths, K or mK for contrasts, % or 1 for relative values",
            .place = of(&BudgetRow::unit),
            .check = check_budget_unit},
           {.name = "distribution",
            .type = ChoiceKey{distribution_words()},
            .sentence = "Distribution of the value",
            .place = distribution_place(),
            .other_names = {"kind"}},
           {.name = "coverage_factor",
            .type = NumberKey{positive},
            .sentence = "Coverage factor of a normal value. The standard uncertainty is value / coverage_factor",
            .place = of(&BudgetRow::coverage_factor),
            .check = check_coverage_factor},
           {.name = "degrees_of_freedom",
            .type = NumberOrWordKey{NumberRange::between(1, 1e12), "infinite"},
            .sentence = "Degrees of freedom of the value",
            .place = of(&BudgetRow::degrees_of_freedom),
            .other_names = {"nu"}},
           {.name = "enters",
            .type = ChoiceKey{names_of(budget_inputs)},
            .sentence =
                "Input through which the row affects the acuity. With 'by-name' it follows from the name of the row",
            .place = of(&BudgetRow::enters),
            .written_at_default = false},
           {.name = "sensitivity",
            .type = OptionalNumberKey{any_sign},
            .sentence = "Change of ln acuity for a change of the value by 1 unit. By default it follows from the input "
                        "that the row enters",
            .place = of(&BudgetRow::sensitivity)},
           {.name = "source",
            .type = TextKey{},
            .sentence = "Source of the value, in free text",
            .place = of(&BudgetRow::source)},
           {.name = "certificate",
            .type = TextKey{},
            .sentence = "Number of the certificate of the value",
            .place = of(&BudgetRow::certificate)},
           {.name = "common",
            .type = ChoicesKey{names_of(budget_commons), "word", MayBeEmpty::yes},
            .sentence = "Results that share the error of this row: the twin, a series of runs, the contrasts. The row "
                        "cancels in comparisons with them",
            .place = of(&BudgetRow::common)}},
      .rows = rows_of(rows),
      .form = {"Uncertainty budget", "planBudget"},
      .other_names = {"components", "row", "rows"}};
}

}  // namespace todbench
