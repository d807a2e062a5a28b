// SPDX-License-Identifier: GPL-3.0-or-later
// Accuracy bill of a run: the time of each part and its result, errors that no measuring time reduces, and effects that
// the simulation leaves out.
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
  std::optional<double> seconds{};     ///< empty: cannot be separated from the other parts
  std::string bought{};                ///< result of the part, in words with numbers
  std::optional<double> forecast_s{};  ///< forecast from the plan before the run; empty: not forecast
};

struct AccuracyBill {
  std::vector<BillRow> rows;
  double total_s = 0;
  std::optional<double> forecast_s{};  ///< forecast of the total, without computing; empty: none
  /// Sentences about the limits of accuracy, the least time for the verdict, and effects left out.
  std::vector<std::string> sentences;
};

/// Input of accuracy_bill(). The objects to which the input refers must exist during the call.
struct BillInput {
  std::span<const Presentation> presentations;
  const TodCurve& curve;
  const CurveUncertainty* uncertainty = nullptr;  ///< null: the plan has no budget
  const Verdict* verdict = nullptr;               ///< null: not judged
  const SensorPlan& effects;
  double wall_s = 0;           ///< duration of the run with its physical measures, without the twin
  double measures_s = 0;       ///< part of wall_s: physical measures with their changes of the target; 0: none
  std::size_t quantities = 0;  ///< number of quantities of the physical measures
  const TimeForecast* forecast = nullptr;  ///< forecast of the plan; null: no comparable forecast
  double twin_s = 0;                       ///< duration of the simulation of the twin, after the run; 0: none
};

/// Divides the time of a run into parts. A presentation begins when the target is in place and ends when the next
/// change of the target begins. The first presentation of a set-up or a contrast also locates the plate and measures
/// the contrast. The time for both is the excess over the median of the other presentations at the same contrast. If
/// there are no other presentations, the time is the excess over the forecast. Without a forecast, this time is not
/// separated. If the presentations have no times, all time except the time of the physical measures counts as
/// computing.
///
/// The least time for the verdict is the time with the fewest presentations that are sufficient for the verdict, in the
/// same set-ups. The half-width from the trials is assumed to decrease with the square root of the number of
/// presentations. Each set-up keeps at least one presentation, and for graded answers at least
/// `least_graded_presentations` remain.
[[nodiscard]] AccuracyBill accuracy_bill(const BillInput& input);

/// Returns one sentence for each reason for which the simulation leaves out effects. The reasons are: below the
/// tolerance (with the bound of the change), on request (with the planner's estimate if there is one), and neutral in
/// this sensor and scene. Never empty.
[[nodiscard]] std::vector<std::string> left_out_sentences(const SensorPlan& effects);

/// Returns the share of the presentations that is sufficient for a decision. A value above 1 means that more
/// presentations are necessary. `margin`: distance from the limit. `half_width`: half-width from the trials, which
/// falls with the square root of the number of presentations. `floor`: half-width that does not fall. All three are 100
/// times ln acuity. Empty: the floor is not below the margin.
[[nodiscard]] std::optional<double> share_for_decision(double half_width, double margin, double floor);

/// Sentences for plans without a budget or without a limit.
inline constexpr std::string_view no_budget_sentence =
    "The plan states no row of a budget, so it is not known what no presentation reduces.";
inline constexpr std::string_view no_limit_sentence =
    "The plan has no limit on an acuity, so there is no least time for a verdict.";

/// Names of the parts that are also forecast from a plan.
inline constexpr std::string_view changes_part = "Changes of the target";
inline constexpr std::string_view location_part = "Location of the plate, contrasts";
inline constexpr std::string_view measures_part = "Physical measures";
[[nodiscard]] std::string presentations_part(double set_delta_t_k);

/// Returns the times of a forecast; empty if it has none.
[[nodiscard]] std::optional<TimeForecast> time_forecast(const AccuracyBill& forecast);
/// Returns a sentence that compares the forecast with the outcome, for the total and every part of a bill. Empty
/// without a forecast.
[[nodiscard]] std::string forecast_and_outcome(const AccuracyBill& bill);

/// Returns {"total_s", "rows": [{"part", "seconds", "bought"}], "sentences": [...]}. The bill and each row also have
/// "forecast_s" if they were forecast.
[[nodiscard]] Json bill_json(const AccuracyBill& bill);
/// Returns the section of the report.
[[nodiscard]] Section bill_section(const AccuracyBill& bill);

}  // namespace todbench
