// SPDX-License-Identifier: GPL-3.0-or-later
// What the time of a run bought, what no time can buy, and what was left out.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/judgement/verdict.h"
#include "bench/report/document.h"
#include "bench/session/provenance.h"
#include "bench/text/json.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "tod/presentation/presentation.h"

namespace todbench {

/// Part of the time of a run.
struct BillRow {
  std::string part;
  std::optional<double> seconds{};     ///< empty: cannot be separated from the others
  std::string bought{};                ///< words with numbers
  std::optional<double> forecast_s{};  ///< by the plan before the run; empty: not forecast
};

struct AccuracyBill {
  std::vector<BillRow> rows;
  double total_s = 0;
  std::optional<double> forecast_s{};  ///< of the total, without computing; empty: not forecast
  std::vector<std::string> sentences;  ///< limits of accuracy, least time for the verdict, effects left out
};

/// Input of accuracy_bill(). Borrows for the call.
struct BillInput {
  std::span<const Presentation> presentations;
  const TodCurve& curve;
  const CurveUncertainty* uncertainty = nullptr;  ///< null: the plan has no budget
  const Verdict* verdict = nullptr;               ///< null: not judged
  const SensorPlan& effects;
  double wall_s = 0;           ///< of the run with its physical measures, without the twin
  double measures_s = 0;       ///< part of wall_s: physical measures with their changes of the target; 0: none
  std::size_t quantities = 0;  ///< of the physical measures
  const TimeForecast* forecast = nullptr;  ///< of the plan; null: none that is comparable
  double twin_s = 0;                       ///< of the simulation of the twin, which follows the run; 0: none
};

/// Divides the time of a run. A presentation begins when the target is in place and ends when its next change begins.
/// The first presentation of a set-up or a contrast also locates the plate and measures the contrast: the excess over
/// the median presentation of the same contrast is that time, or, if every presentation of the contrast is a first one,
/// the excess over the forecast; without a forecast the location has no time. If the presentations have no times, all
/// time beside the physical measures is computing. The least time for the verdict keeps the set-ups and assumes that
/// the half-width of the trials falls with the root of the presentations, at least one of each set-up and
/// `least_graded_presentations`.
[[nodiscard]] AccuracyBill accuracy_bill(const BillInput& input);

/// Returns the effects that the simulation leaves out, one sentence for each reason: below the tolerance with the bound
/// of its change, on request with the planner's estimate if it has one, neutral in this sensor and scene. Never empty.
[[nodiscard]] std::vector<std::string> left_out_sentences(const SensorPlan& effects);

/// Returns the share of the presentations that decides with this distance from the limit; above 1: more than there are.
/// The half-width of the trials falls with the root of the presentations, the floor stays. All in percent of the
/// acuity. Empty: the floor exceeds the distance.
[[nodiscard]] std::optional<double> share_for_decision(double half_width, double margin, double floor);

/// Lines in place of those that need a budget or a limit.
inline constexpr std::string_view no_budget_sentence =
    "The plan states no row of a budget, so it is not known what no presentation reduces.";
inline constexpr std::string_view no_limit_sentence =
    "The plan has no limit on an acuity, so there is no least time for a verdict.";

/// Names of the parts that a plan forecasts too.
inline constexpr std::string_view changes_part = "Changes of the target";
inline constexpr std::string_view location_part = "Location of the plate, contrasts";
inline constexpr std::string_view measures_part = "Physical measures";
[[nodiscard]] std::string presentations_part(double set_delta_t_k);

/// Returns the times of a forecast; empty if it has none.
[[nodiscard]] std::optional<TimeForecast> time_forecast(const AccuracyBill& forecast);
/// Returns a sentence with the total and every part of a bill, forecast beside outcome. Empty without a forecast.
[[nodiscard]] std::string forecast_and_outcome(const AccuracyBill& bill);

/// Returns {"total_s", "rows": [{"part", "seconds", "bought"}], "sentences": [...]}; the bill and a row that were
/// forecast also have "forecast_s".
[[nodiscard]] Json bill_json(const AccuracyBill& bill);
/// Returns the section of the report.
[[nodiscard]] Section bill_section(const AccuracyBill& bill);

}  // namespace todbench
