// SPDX-License-Identifier: GPL-3.0-or-later
// Conformity with limits and uncertainty budgets.
#include "bench/judgement/conformity.h"
#include "bench/judgement/uncertainty_budget.h"
#include "bench/python/bindings.h"

namespace todbench {
namespace {

void add_conformity(py::module_& module) {
  // clang-format off
  py::class_<Conformity>(module, "Conformity", "Decision on a measured value, with its risks.")
      .def_readonly("decision", &Conformity::decision, "'pass', 'conditional pass', 'inconclusive', 'conditional fail' or 'fail'.")
      TODBENCH_READ(Conformity, guard_band)
      .def_property_readonly("acceptance_limits", [](const Conformity& found) {
            return py::make_tuple(found.acceptance.at_least, found.acceptance.at_most); },
            doc("Conformity::acceptance"))
      TODBENCH_READ(Conformity, acceptance_zone_is_empty)
      TODBENCH_READ(Conformity, p_conformity)
      TODBENCH_READ(Conformity, p_nonconformity);
  // clang-format on
  module.def(
      "conformity",
      [](double value, double u, std::optional<double> at_least, std::optional<double> at_most, ConformityRule rule,
         std::optional<double> guard_band, std::optional<double> degrees_of_freedom) {
        const MeasuredValue measured{value, u, degrees_of_freedom};
        return take(
            conformity(measured, {at_least, at_most}, rule, guard_band ? *guard_band : usual_guard_band(measured)));
      },
      py::arg("value"), py::arg("u"), py::arg("at_least") = py::none(), py::arg("at_most") = py::none(),
      py::arg("rule") = ConformityRule::guarded_acceptance_and_rejection, py::arg("guard_band") = py::none(),
      py::arg("degrees_of_freedom") = py::none(),
      "Decides by a named rule; the guard band is 2 u, by Student's t with degrees of freedom, unless stated. Raises "
      "`invalid_input` without a limit, for limits\n"
      "in the wrong order, and for u of 0 or less.");
  module.def(
      "guard_band_for_risk",
      [](double risk, double value, double u, std::optional<double> degrees_of_freedom) {
        return guard_band_for_risk(risk, {value, u, degrees_of_freedom});
      },
      py::arg("risk"), py::arg("value"), py::arg("u"), py::arg("degrees_of_freedom") = py::none(),
      doc("guard_band_for_risk"));
}

void add_budget(py::module_& module) {
  // clang-format off
  py::class_<BudgetRow>(module, "BudgetRow", doc("BudgetRow"))
      .def_readonly("name", &BudgetRow::name, "Name of the row.")
      TODBENCH_READ(BudgetRow, value)
      .def_readonly("unit", &BudgetRow::unit, "Unit of the value.")
      .def_readonly("distribution", &BudgetRow::distribution, doc("BudgetDistribution"))
      TODBENCH_READ(BudgetRow, coverage_factor)
      TODBENCH_READ(BudgetRow, degrees_of_freedom)
      TODBENCH_READ(BudgetRow, sensitivity)
      TODBENCH_READ(BudgetRow, source)
      TODBENCH_READ(BudgetRow, certificate);
  py::class_<BudgetShare>(module, "BudgetShare", doc("BudgetShare"))
      TODBENCH_READ(BudgetShare, standard_uncertainty)
      TODBENCH_READ(BudgetShare, contribution)
      TODBENCH_READ(BudgetShare, share_percent);
  py::class_<CombinedUncertainty>(module, "CombinedUncertainty", "A budget combined.")
      TODBENCH_READ(CombinedUncertainty, u)
      TODBENCH_READ(CombinedUncertainty, nu_eff)
      TODBENCH_READ(CombinedUncertainty, k)
      TODBENCH_READ(CombinedUncertainty, expanded_gum)
      TODBENCH_READ(CombinedUncertainty, expanded_monte_carlo)
      TODBENCH_READ(CombinedUncertainty, expanded)
      TODBENCH_READ(CombinedUncertainty, shares);
  py::class_<UncertaintyBudget>(module, "UncertaintyBudget", "Rows of an uncertainty budget.")
      .def_readonly("quantity", &UncertaintyBudget::quantity, "Quantity of the result.")
      TODBENCH_READ(UncertaintyBudget, unit)
      .def_readonly("rows", &UncertaintyBudget::rows, doc("BudgetRow"))
      // clang-format on
      .def(
          "combined",
          [](const UncertaintyBudget& budget, std::uint64_t seed, int draws) {
            return take(combined(budget, seed, draws));
          },
          py::arg("seed") = 1, py::arg("draws") = budget_draws, py::call_guard<py::gil_scoped_release>(),
          doc("combined"));
  module.def(
      "read_budget", [](const std::filesystem::path& file) { return take(read_budget(file)); }, py::arg("file"),
      doc("read_budget"));
}

}  // namespace

void add_judgement(py::module_& module) {
  add_conformity(module);
  add_budget(module);
}

}  // namespace todbench
