// Keys of limits, what is known of a fleet, and the budget.
#include "bench/plan/plan_sections.h"

#include "bench/plan/key_places.h"
#include "bench/plan/plan_checks.h"

namespace todbench {

namespace {

/// Words of distributions: their names, and what a budget may say in place of them.
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

/// "rectangular half-width" is "rectangular".
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
      .sentence = "What is demanded of the result.",
      .keys = {
          {.name = "equivalence_margin_percent",
           .type = OptionalNumberKey{NumberRange::above_to(0, 100)},
           .unit = "%",
           .sentence = "demanded agreement with the twin; without it none is demanded",
           .place = in(&Plan::limits, &LimitsPlan::equivalence_margin_percent),
           .form = {"Equivalence margin", "planMargin"},
           .check = check_margin},
          {.name = "rule",
           .type = ChoiceKey{names_of(conformity_rules)},
           .sentence = "how an interval and a limit make a decision, agreed before the measurement",
           .place = in(&Plan::limits, &LimitsPlan::rule),
           .written_at_default = false},
          {.name = "guard_band_risk",
           .type = OptionalNumberKey{NumberRange::between(1e-9, 0.5)},
           .sentence = "of a wrong acceptance at the acceptance limit; without it the guard band is the 95 % interval",
           .place = in(&Plan::limits, &LimitsPlan::guard_band_risk)},
          {.name = "fleet_sd_percent",
           .type = OptionalNumberKey{NumberRange::above_to(0, 100)},
           .unit = "%",
           .sentence = "spread of true acuities over the fleet; todbench plan then states the risks of both sides",
           .place = in(&Plan::limits, &LimitsPlan::fleet_sd_percent)}}};
}

PlanSection acuity_limits_section() {
  const auto rows = [](auto& plan) -> auto& {
    return plan.limits.acuity;
  };
  return {.name = "limits.acuity",
          .sentence = "The 75 % acuity demanded at a contrast.",
          .keys = {{.name = "delta_t_k",
                    .type = NumberKey{NumberRange::any()},
                    .unit = "K",
                    .sentence = "one of the contrasts of [target]",
                    .place = in_row(rows, &AcuityLimit::delta_t_k),
                    .required = Required::always,
                    .check = check_limit_contrast},
                   {.name = "least_acuity_per_mrad",
                    .type = NumberKey{positive},
                    .unit = "1/mrad",
                    .sentence = "what the unit has to reach there",
                    .place = in_row(rows, &AcuityLimit::least_acuity_per_mrad),
                    .required = Required::always}},
          .rows = rows_of(rows),
          .form = {"Least acuity", "planLimits", "target.delta_t_k"}};
}

PlanSection measure_limits_section() {
  const auto rows = [](auto& plan) -> auto& {
    return plan.limits.measures;
  };
  return {.name = "limits.measure",
          .sentence =
              "Limits on a physical measure of [measures], in its unit (K; K/K for transfer_slope, 1 for MTF and CTF).",
          .keys = {{.name = "measure",
                    .type = ChoiceKey{names_of(limited_measures)},
                    .sentence = "by its name in measures.json",
                    .place = in_row(rows, &MeasureLimit::measure),
                    .required = Required::always,
                    .check = check_limited_measure},
                   {.name = "at_least",
                    .type = OptionalNumberKey{positive},
                    .sentence = "lower limit of transfer_slope, an MTF, a CTF or an IFOV",
                    .place = in_row(rows, &MeasureLimit::at_least)},
                   {.name = "at_most",
                    .type = OptionalNumberKey{positive},
                    .sentence = "upper limit; MTF and CTF have none",
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
      .sentence = "Most bad and substituted pixels in a part of the frame. Zones do not overlap, but for 'whole'.",
      .keys = {{.name = "name",
                .type = TextKey{},
                .sentence = "of the zone; 'whole' is the frame, whatever its area",
                .place = in_row(rows, &ZoneLimit::name),
                .required = Required::always,
                .check = check_zone_name},
               {.name = "area",
                .type = NumbersKey{share, "four numbers: left, top, right, bottom", 4},
                .sentence = "in fractions of the frame",
                .place = in_row(rows, &ZoneLimit::area),
                .check = check_zone_area},
               most("bad_pixels", "stuck, dead, hot, noisy and blinking ones", &ZoneLimit::bad_pixels),
               most("substituted_pixels", "that the camera has replaced by their neighbours",
                    &ZoneLimit::substituted_pixels),
               most("clusters", "of two bad or substituted pixels that touch, or more", &ZoneLimit::clusters),
               most("largest_cluster", "pixels", &ZoneLimit::largest_cluster)},
      .rows = rows_of(rows),
      .form = {"Limits on pixels by zone", "planZoneLimits"}};
  section.keys.back().check = check_zone_limits;
  return section;
}

PlanSection fleet_section() {
  const auto rows = [](auto& plan) -> auto& {
    return plan.limits.fleets;
  };
  return {.name = "limits.fleet",
          .sentence =
              "What earlier units of this kind say of the next one, as `todbench history prior` writes it; the "
              "verdict then states global risks.",
          .keys = {{.name = "measure",
                    .type = TextKey{},
                    .sentence = "acuity, or a physical measure that can be limited",
                    .place = in_row(rows, &FleetRow::measure),
                    .required = Required::always,
                    .check = check_fleet_measure},
                   {.name = "delta_t_k",
                    .type = OptionalNumberKey{NumberRange::any()},
                    .unit = "K",
                    .sentence = "set contrast of an acuity",
                    .place = in_row(rows, &FleetRow::delta_t_k)},
                   {.name = "mean",
                    .type = NumberKey{positive},
                    .sentence = "of true values, in the unit of the measure; of an acuity the geometric one",
                    .place = in_row(rows, &FleetRow::mean),
                    .required = Required::always},
                   {.name = "sd",
                    .type = NumberKey{positive},
                    .sentence = "standard deviation of true values, in that unit; of an acuity in ln acuity",
                    .place = in_row(rows, &FleetRow::sd),
                    .required = Required::always},
                   {.name = "u",
                    .type = NumberKey{not_negative},
                    .sentence = "standard uncertainty of a value that went into it, on the scale of sd",
                    .place = in_row(rows, &FleetRow::u)},
                   {.name = "units",
                    .type = WholeKey{least_fleet_units, 1000000},
                    .sentence = "that it rests on",
                    .place = in_row(rows, &FleetRow::units),
                    .required = Required::always},
                   {.name = "source",
                    .type = TextKey{},
                    .sentence = "where they are, in words",
                    .place = in_row(rows, &FleetRow::source)}},
          .rows = rows_of(rows),
          .form = {"Earlier units of the fleet", "planFleets"}};
}

PlanSection uncertainty_section() {
  return {.name = "uncertainty",
          .sentence =
              "What the interval of the finite number of trials does not hold. A plan with rows is judged by the "
              "interval expanded by them.",
          .keys = {{.name = "require",
                    .type = FlagKey{},
                    .sentence = "refuse a plan whose budget leaves out an expected row",
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
      .sentence = "A row of the budget, as in the file of todbench budget.",
      .keys = {{.name = "name",
                .type = TextKey{},
                .sentence = "what is uncertain",
                .place = of(&BudgetRow::name),
                .required = Required::always,
                .check = check_budget_name},
               {.name = "value",
                .type = NumberKey{not_negative},
                .sentence = "standard uncertainty, half-width or amplitude, as the distribution says; 0: known exactly",
                .place = of(&BudgetRow::value),
                .required = Required::always},
               {.name = "unit",
                .type = TextKey{},
                .sentence = "of the value: m, cm, mm, um of lengths, K, mK of contrasts, %, 1",
                .place = of(&BudgetRow::unit),
                .check = check_budget_unit},
               {.name = "distribution",
                .type = ChoiceKey{distribution_words()},
                .sentence = "of the value",
                .place = distribution_place(),
                .other_names = {"kind"}},
               {.name = "coverage_factor",
                .type = NumberKey{positive},
                .sentence = "of a normal value: value / coverage_factor is standard",
                .place = of(&BudgetRow::coverage_factor),
                .check = check_coverage_factor},
               {.name = "degrees_of_freedom",
                .type = NumberOrWordKey{NumberRange::between(1, 1e300), "infinite"},
                .sentence = "of the value",
                .place = of(&BudgetRow::degrees_of_freedom),
                .other_names = {"nu"}},
               {.name = "enters",
                .type = ChoiceKey{names_of(budget_inputs)},
                .sentence = "through what the row reaches the acuity",
                .place = of(&BudgetRow::enters),
                .written_at_default = false},
               {.name = "sensitivity",
                .type = OptionalNumberKey{NumberRange::any()},
                .sentence = "of ln acuity to the value; without it that of what the row enters",
                .place = of(&BudgetRow::sensitivity)},
               {.name = "source",
                .type = TextKey{},
                .sentence = "what the value rests on",
                .place = of(&BudgetRow::source)},
               {.name = "certificate",
                .type = TextKey{},
                .sentence = "number of its certificate",
                .place = of(&BudgetRow::certificate)},
               {.name = "common",
                .type = ChoicesKey{names_of(budget_commons), "word", MayBeEmpty::yes},
                .sentence = "with what the row is shared: it cancels in a ratio to it",
                .place = of(&BudgetRow::common)}},
      .rows = rows_of(rows),
      .other_names = {"components", "row", "rows"}};
}

}  // namespace todbench
