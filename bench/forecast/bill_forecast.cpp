// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/forecast/bill_forecast.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/forecast/bench_time.h"
#include "bench/forecast/contrast_forecast.h"
#include "bench/forecast/decision_forecast.h"
#include "bench/plan/plan_options.h"
#include "bench/report/number_format.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

void add_rows(AccuracyBill& bill, const BenchTime& time, double frame_rate_hz,
              const std::vector<ContrastPrediction>& contrasts) {
  const auto seconds = [&](std::uint64_t frames) { return static_cast<double>(frames) / frame_rate_hz; };
  bill.rows.push_back({std::string(changes_part), time.changes_s - time.all_measures.changes_s - time.warm_up_s,
                       fmt::format("{} set-ups, {} contrasts, {} places of the plate in the picture", time.set_ups,
                                   contrasts.size(), time.presentations)});
  bill.rows.push_back(
      {std::string(location_part), seconds(time.looking_frames), "place of the plate and effective contrasts"});
  for (const ContrastPrediction& contrast : contrasts) {
    const auto found = time.presentation_frames.find(contrast.delta_t_k);
    const std::uint64_t frames = found != time.presentation_frames.end() ? found->second : 0;
    bill.rows.push_back({presentations_part(contrast.delta_t_k), seconds(frames),
                         contrast.uncertainty_percent ? fmt::format("S75 to ± {} % (95 %) or better",
                                                                    significant(*contrast.uncertainty_percent, 2))
                                                      : "no interval of S75"});
  }
  if (!time.measures.empty()) {
    std::vector<std::string> measures;
    for (const MeasureTime& one : time.measures)
      measures.push_back(fmt::format("{} {:.1f} s", one.measure, one.changes_s + seconds(one.frames)));
    bill.rows.push_back({std::string(measures_part), time.all_measures.changes_s + seconds(time.all_measures.frames),
                         fmt::format("with their changes of the target: {}", fmt::join(measures, ", "))});
  }
  // A run waits for them within its presentations and measures, so its bill has no such row.
  if (time.corrections_s > 0)
    bill.rows.push_back({"Corrections of the camera", time.corrections_s, "within the rows above in a run"});
  if (time.warm_up_s > 0)
    bill.sentences.push_back(
        fmt::format("The warm-up of the camera takes at least {:.0f} s before the run.", time.warm_up_s));
}

/// What the decision on a limit needs.
struct DecisionNeed {
  double share = 0;          ///< of the presentations at its contrast
  double half_width_ln = 0;  ///< of the trials
};

/// Returns what decides the limit for a camera of the predicted acuity; empty, with a sentence, if no presentation
/// does. `floor_ln`: half-width of the stated rows. `contrast_frames`: deciding_contrast_frames().
std::optional<DecisionNeed> needed_for(AccuracyBill& bill, const AcuityLimit& limit, const ContrastPrediction& contrast,
                                       double floor_ln, const std::optional<int>& contrast_frames) {
  const std::string at = number_text(contrast.delta_t_k) + " K";
  if (!contrast.s75_mrad || !contrast.uncertainty_percent) {
    bill.sentences.push_back("No least time for the decision at " + at + ": no interval of S75 is predicted.");
    return std::nullopt;
  }
  const double margin = std::abs(std::log(*contrast.s75_mrad * limit.least_acuity_per_mrad));
  const double fixed = std::hypot(floor_ln, contrast.contrast_half_width);
  const double all = std::log1p(*contrast.uncertainty_percent / 100);
  const double trials = std::sqrt(std::max(0.0, all * all - std::pow(contrast.contrast_half_width, 2)));
  const auto share = share_for_decision(trials, margin, fixed);
  if (share) return DecisionNeed{*share, std::sqrt(margin * margin - fixed * fixed)};
  bill.sentences.push_back(fmt::format(
      "No number of presentations decides the predicted acuity at {}: it is {} % from its limit; the stated rows of "
      "the budget make ± {} %, and the measured contrast ± {} %.{}",
      at, significant(100 * std::expm1(margin), 2), significant(100 * std::expm1(floor_ln), 2),
      significant(100 * std::expm1(contrast.contrast_half_width), 2),
      contrast_frames ? fmt::format(" Presentations decide it with {} frames of the contrast ([measurement] "
                                    "contrast_frames).",
                                    *contrast_frames)
                      : ""));
  return std::nullopt;
}

std::string need_in_words(const Plan& plan, const DecisionNeed& need, double delta_t_k) {
  const std::string decision = "The decision on the predicted acuity at " + number_text(delta_t_k) + " K needs ";
  if (plan.schedule.kind == ScheduleKind::adaptive)
    return fmt::format("{}a half-width of {} % ([schedule] half_width_percent, {:g} in the plan).", decision,
                       significant(100 * std::expm1(need.half_width_ln), 2), plan.schedule.half_width_percent);
  if (plan.schedule.kind == ScheduleKind::ramp)
    return fmt::format("{}about {} % of the presentations of the plan: a ramp of about {} K/s in place of {:g}.",
                       decision, significant(100 * need.share, 2),
                       significant(plan.schedule.ramp_k_per_s.value_or(0) / need.share, 2),
                       plan.schedule.ramp_k_per_s.value_or(0));
  return fmt::format("{}about {} % of the presentations of the plan.", decision, significant(100 * need.share, 2));
}

/// Adds what the plan's limits on acuity need. `floors_ln`: half-widths of the stated rows, one for each contrast.
Result<void> add_least(AccuracyBill& bill, const Plan& plan, const ExperimentInputs& inputs, const BenchTime& time,
                       const PlanPrediction& prediction, const std::vector<double>& floors_ln) {
  if (plan.limits.acuity.empty()) {
    bill.sentences.emplace_back(no_limit_sentence);
    return {};
  }
  const auto set_ups = static_cast<double>(time.set_ups);
  const double each = static_cast<double>(time.presentations) / static_cast<double>(prediction.contrasts.size());
  const double least = std::min(1.0, std::max<double>(set_ups, least_graded_presentations) / std::max(1.0, each));
  const double shifts_s = std::max(0.0, each - set_ups) * plan.target.shift_change_s;  // of a contrast
  const auto seconds_of = [&](std::string_view part) {
    const auto row = std::ranges::find(bill.rows, part, &BillRow::part);
    return row == bill.rows.end() ? 0 : row->seconds.value_or(0);
  };
  bool decided = false, by_contrast_frames = false;
  double needed_s = seconds_of(changes_part) + seconds_of(location_part), all_s = needed_s;
  for (std::size_t i = 0; i < prediction.contrasts.size(); ++i) {
    const ContrastPrediction& contrast = prediction.contrasts[i];
    double most = 0;
    for (const AcuityLimit& limit : plan.limits.acuity) {
      if (!same_contrast(limit.delta_t_k, contrast.delta_t_k)) continue;
      TODBENCH_TRY(const auto contrast_frames,
                   deciding_contrast_frames(plan, inputs, contrast, limit.least_acuity_per_mrad, floors_ln[i]));
      by_contrast_frames = by_contrast_frames || contrast_frames;
      auto need = needed_for(bill, limit, contrast, floors_ln[i], contrast_frames);
      if (!need) continue;
      need->share = std::max(need->share, least);
      decided = true;
      most = std::max(most, need->share);
      bill.sentences.push_back(need_in_words(plan, *need, contrast.delta_t_k));
    }
    const double contrast_s = seconds_of(presentations_part(contrast.delta_t_k));
    needed_s += most * contrast_s + (most - 1) * shifts_s;
    all_s += contrast_s;
  }
  if (decided && plan.schedule.kind == ScheduleKind::constant)
    bill.sentences.push_back(fmt::format(
        "In the set-ups of the plan, the decisions on acuity alone need about {} s; {} s are planned for changes, "
        "location and presentations.",
        significant(needed_s, 2), significant(all_s, 2)));
  if (decided || by_contrast_frames)
    bill.sentences.emplace_back("`todbench plan --optimise --decide` looks for the fastest design that decides.");
  return {};
}

}  // namespace

Result<AccuracyBill> bill_forecast(const Plan& asked, const ExperimentInputs& inputs) {
  AccuracyBill bill;
  if (asked.target.kind == TargetKind::scene) return bill;
  const Plan plan = as_measured(with_frames(asked, inputs));
  TODBENCH_TRY(const auto prediction, predict_plan(plan, inputs));
  const double frame_rate_hz = inputs.sensor.frame_rate_hz;
  const BenchTime time = expected_bench_time(plan, inputs, prediction);
  bill.total_s = time.total_s() - time.warm_up_s;
  if (frame_rate_hz > 0) add_rows(bill, time, frame_rate_hz, prediction.contrasts);
  if (plan.schedule.kind == ScheduleKind::adaptive)
    bill.sentences.push_back(
        fmt::format("The times of this adaptive schedule are means; eight of ten simulated runs take between {:.0f} s "
                    "and {:.0f} s.",
                    time.short_s - time.warm_up_s, time.long_s - time.warm_up_s));
  TODBENCH_TRY(const auto floors, floors_ln(plan, prediction));
  if (std::ranges::none_of(floors, [](double floor) { return floor > 0; }))
    bill.sentences.emplace_back(no_budget_sentence);
  for (std::size_t i = 0; i < floors.size(); ++i) {
    if (!(floors[i] > 0)) continue;
    bill.sentences.push_back(
        fmt::format("At {} K the stated rows of the budget make ± {} %, which no presentation reduces.",
                    number_text(prediction.contrasts[i].delta_t_k), significant(100 * std::expm1(floors[i]), 2)));
  }
  TODBENCH_TRY_VOID(add_least(bill, plan, inputs, time, prediction, floors));
  for (std::string& sentence : left_out_sentences(inputs.effects)) bill.sentences.push_back(std::move(sentence));
  return bill;
}

Result<AccuracyBill> bill_forecast(const LoadedPlan& loaded) {
  EffectPlanner planner;
  TODBENCH_TRY(const auto inputs, experiment_inputs(loaded, planner));
  return bill_forecast(loaded.plan(), inputs);
}

}  // namespace todbench
