// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/forecast/precision_frontier.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "acquisition/base/try.h"
#include "bench/forecast/bench_time.h"
#include "bench/forecast/decision_forecast.h"
#include "bench/forecast/graded_precision.h"
#include "bench/forecast/time_prediction.h"
#include "bench/plan/plan_options.h"

namespace todbench {
namespace {

Plan with_answers(Plan plan, AnswerKind answers, const std::vector<int>& frames) {
  plan.schedule.answers = answers == AnswerKind::graded ? AnswersChoice::graded : AnswersChoice::binary;
  plan.schedule.frames_per_presentation = frames;
  if (answers == AnswerKind::graded) {
    plan.fit.estimator = EstimatorChoice::twin_shape;
    plan.fit.lapse = 0.0;
  }
  return plan;
}

/// Computing time of a choice, for the camera if there is one.
Result<double> computing_s(const Plan& plan, const ExperimentInputs& inputs, std::stop_token stop) {
  TODBENCH_TRY(const auto time, predict_time(plan, inputs, std::move(stop)));
  return plan.camera.id.empty() ? time.simulation_s : time.measuring_s;
}

double bench_s(const Plan& plan, const ExperimentInputs& inputs, const PlanPrediction& prediction) {
  return plan.camera.id.empty() ? 0 : expected_bench_time(plan, inputs, prediction).total_s();
}

double mean_of(const std::vector<int>& frames) {
  return std::accumulate(frames.begin(), frames.end(), 0.0) / static_cast<double>(frames.size());
}

/// Computing times of the choices.
struct ComputingTimes {
  double binary_s = 0, graded_s = 0;  ///< graded: with `frames` frames
  double frames = 1, frame_s = 0;
  [[nodiscard]] double graded(double count) const { return std::max(0.0, graded_s + (count - frames) * frame_s); }
};

/// Computing times of the choices of a plan. `own`: frames of the plan. `own_s`: its computing time, which its choice
/// keeps.
Result<ComputingTimes> computing_times(const Plan& plan, const ExperimentInputs& inputs, const std::vector<int>& own,
                                       double own_s, const std::stop_token& stop) {
  ComputingTimes times{.binary_s = own_s, .graded_s = own_s};
  const auto timed = [&](AnswerKind answers, int frames) {
    return computing_s(with_answers(plan, answers, {frames}), inputs, stop);
  };
  if (chosen_answers(plan, inputs.sensor).kind == AnswerKind::graded) {
    times.frames = mean_of(own);
    if (plan.schedule.kind == ScheduleKind::ramp) return times;
    TODBENCH_TRY(times.binary_s, timed(AnswerKind::binary, 1));
  } else {
    TODBENCH_TRY(times.graded_s, timed(AnswerKind::graded, 1));
  }
  // Far from the first number, so that the load of the computer changes the time of a frame little.
  const int second = times.frames < 4 ? 8 : 1;
  TODBENCH_TRY(const double second_s, timed(AnswerKind::graded, second));
  times.frame_s = std::max(0.0, (second_s - times.graded_s) / (second - times.frames));
  return times;
}

/// Largest half-width over the contrasts with the rows of the budget (`floors`, in ln acuity), which frames do not
/// reduce.
double deciding_ln(const PrecisionChoice& choice, const std::vector<double>& floors) {
  double largest = 0;
  for (std::size_t i = 0; i < choice.contrasts.size(); ++i)
    largest = std::max(largest, std::hypot(std::log1p(*choice.contrasts[i].uncertainty_percent / 100), floors[i]));
  return largest;
}

void recommend(std::vector<PrecisionChoice>& choices, const std::vector<double>& floors) {
  const auto seconds = [](const PrecisionChoice& choice) {
    return choice.bench_s > 0 ? choice.bench_s : choice.seconds;
  };
  const auto price = [&](const PrecisionChoice& choice) {
    return std::pow(deciding_ln(choice, floors), 2) * std::max(seconds(choice), 1e-3);
  };
  const auto comparable = [](const PrecisionChoice& choice) {
    return choice.answers == AnswerKind::graded && choice.half_width_percent;
  };
  PrecisionChoice* best = nullptr;
  for (PrecisionChoice& choice : choices) {
    if (comparable(choice) && (best == nullptr || price(choice) < price(*best))) best = &choice;
  }
  if (best == nullptr) return;
  // With a budget the price is flat, and the faster of nearly equal choices gives away nothing.
  constexpr double nearly = 1.05;
  const double most = price(*best) * (std::ranges::any_of(floors, [](double floor) { return floor > 0; }) ? nearly : 1);
  for (PrecisionChoice& choice : choices) {
    if (comparable(choice) && price(choice) <= most && seconds(choice) < seconds(*best)) best = &choice;
  }
  best->recommended = true;
}

}  // namespace

Result<std::vector<PrecisionChoice>> precision_frontier(const Plan& plan, const ExperimentInputs& inputs,
                                                        std::stop_token stop, PlanFigures figures) {
  // Other frames would change the rate of a ramp, which has no binary answers.
  const bool ramp = plan.schedule.kind == ScheduleKind::ramp;
  const AnswersTaken planned = chosen_answers(plan, inputs.sensor);
  const std::vector<int> own = with_frames(plan, inputs).schedule.frames_per_presentation;
  std::vector<std::vector<int>> frames;
  if (ramp) frames = {own};
  for (const int count : frame_choices)
    if (!ramp) frames.push_back({count});
  if (planned.kind == AnswerKind::graded && std::ranges::find(frames, own) == frames.end()) {
    frames.push_back(own);
    std::ranges::sort(frames);
  }
  if (!figures.predicted_s) {
    PlanPrediction timed;
    TODBENCH_TRY_VOID(predict_times(plan, inputs, timed, stop));
    figures = timed.figures;
  }
  TODBENCH_TRY(const auto expected, predict_plan(as_measured(plan), inputs));
  const double own_s = figures.predicted_measurement_s.value_or(*figures.predicted_s);
  const double own_bench_s = bench_s(with_frames(plan, inputs), inputs, expected);
  TODBENCH_TRY(const auto times, computing_times(plan, inputs, own, own_s - own_bench_s, stop));

  std::vector<PrecisionChoice> choices;
  const auto add = [&](AnswerKind answers, const std::vector<int>& count, double computing) -> Result<void> {
    const Plan other = with_answers(plan, answers, count);
    TODBENCH_TRY(auto prediction, predict_plan(as_measured(other), inputs));
    PrecisionChoice choice{.answers = answers, .frames = count};
    choice.planned = ramp || (planned.kind == answers && (answers == AnswerKind::binary || own == count));
    choice.bench_s = choice.planned ? own_bench_s : bench_s(other, inputs, prediction);
    choice.seconds = choice.planned ? own_s : computing + choice.bench_s;
    choice.half_width_percent = prediction.figures.predicted_uncertainty_percent;
    choice.contrasts = std::move(prediction.contrasts);
    choices.push_back(std::move(choice));
    return {};
  };
  if (!ramp) {
    TODBENCH_TRY_VOID(add(AnswerKind::binary, {1}, times.binary_s));
  }
  for (const std::vector<int>& count : frames)
    TODBENCH_TRY_VOID(add(AnswerKind::graded, count, times.graded(mean_of(count))));
  const auto floors = floors_ln(plan, {.figures = {}, .contrasts = choices.front().contrasts, .warnings = {}});
  if (!floors) return tl::unexpected(floors.error());
  recommend(choices, *floors);
  return choices;
}

Json frontier_json(const std::vector<PrecisionChoice>& choices) {
  Json rows = Json::array();
  for (const PrecisionChoice& choice : choices) {
    Json row;
    row["answers"] = to_string(choice.answers);
    row["frames_per_presentation"] = choice.frames.size() == 1 ? Json(choice.frames[0]) : Json(choice.frames);
    row["half_width_percent"] = json_number(choice.half_width_percent);
    row["predicted_s"] = json_number(choice.seconds);
    row["planned"] = choice.planned;
    row["recommended"] = choice.recommended;
    row["contrasts"] = Json::array();
    for (const ContrastPrediction& contrast : choice.contrasts) {
      row["contrasts"].push_back({{"delta_t_k", json_number(contrast.delta_t_k)},
                                  {"half_width_percent", json_number(contrast.uncertainty_percent)}});
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace todbench
