// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/forecast/bill_forecast.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "acquisition/base/try.h"
#include "bench/forecast/bench_time.h"
#include "bench/forecast/decision_forecast.h"
#include "bench/forecast/precision_frontier.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

void add_rows(AccuracyBill& bill, const Plan& plan, const BenchTime& time, double frame_rate_hz,
              const std::vector<ContrastPrediction>& contrasts) {
  const auto seconds = [&](std::uint64_t frames) { return static_cast<double>(frames) / frame_rate_hz; };
  bill.rows.push_back({std::string(changes_part), time.changes_s - time.all_measures.changes_s - time.warm_up_s,
                       fmt::format("{} set-ups, {} contrasts, {} places of the plate in the picture",
                                   set_ups_of(plan.target), contrasts.size(), time.presentations)});
  bill.rows.push_back(
      {std::string(location_part), seconds(time.looking_frames), "place of the plate and effective contrasts"});
  for (const ContrastPrediction& contrast : contrasts) {
    const auto found = time.presentation_frames.find(contrast.delta_t_k);
    const std::uint64_t frames = found != time.presentation_frames.end() ? found->second : 0;
    bill.rows.push_back({presentations_part(contrast.delta_t_k), seconds(frames),
                         contrast.uncertainty_percent
                             ? fmt::format("S75 to ± {:.2g} % (95 %) or better", *contrast.uncertainty_percent)
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

}  // namespace

Result<AccuracyBill> bill_forecast(const Plan& asked, const ExperimentInputs& inputs) {
  AccuracyBill bill;
  if (asked.target.kind == TargetKind::scene) return bill;
  const Plan plan = as_measured(with_frames(asked, inputs));
  TODBENCH_TRY(const auto prediction, predict_plan(plan, inputs));
  const double frame_rate_hz = inputs.sensor.frame_rate_hz;
  const auto presentations = expected_presentations(plan, inputs.plates, prediction.contrasts);
  const BenchTime time = bench_time(plan, inputs.plates, frame_rate_hz, presentations);
  bill.total_s = time.total_s() - time.warm_up_s;
  if (frame_rate_hz > 0) add_rows(bill, plan, time, frame_rate_hz, prediction.contrasts);
  TODBENCH_TRY(const auto floors, floors_ln(plan, prediction));
  for (std::size_t i = 0; i < floors.size(); ++i) {
    if (!(floors[i] > 0)) continue;
    bill.sentences.push_back(
        fmt::format("At {} K the stated rows of the budget make ± {:.2g} %, which no presentation reduces.",
                    number_text(prediction.contrasts[i].delta_t_k), 100 * std::expm1(floors[i])));
  }
  return bill;
}

Result<AccuracyBill> bill_forecast(const LoadedPlan& loaded) {
  EffectPlanner planner;
  TODBENCH_TRY(const auto inputs, experiment_inputs(loaded, planner));
  return bill_forecast(loaded.plan(), inputs);
}

}  // namespace todbench
