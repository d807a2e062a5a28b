// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/plan_preview.h"

#include <algorithm>
#include <cmath>

#include "acquisition/base/try.h"
#include "bench/forecast/bench_time.h"
#include "bench/forecast/bill_forecast.h"
#include "bench/forecast/graded_precision.h"
#include "bench/forecast/ramp_advice.h"
#include "bench/plan/plan_options.h"
#include "bench/twin/direct_results.h"

namespace todbench {
namespace {

constexpr int least_phases = 2, most_phases = 256;

/// Rescales from `from` to `phases`: intervals of ln S75 fall with the root of the number of answers.
std::optional<double> rescaled_percent(std::optional<double> uncertainty_percent, int from, int phases) {
  if (!uncertainty_percent || from == phases || phases <= 0) return uncertainty_percent;
  return 100 * std::expm1(std::log1p(*uncertainty_percent / 100) * std::sqrt(static_cast<double>(from) / phases));
}

/// Whether visits of an adaptive schedule of one plan are also visits of the other plan.
bool same_visits(const Plan& plan, const Plan& other) {
  return plan.target.delta_t_k.size() == other.target.delta_t_k.size() &&
         set_ups_of(plan.target) == set_ups_of(other.target);
}

const ContrastPrediction* at(const std::vector<ContrastPrediction>& contrasts, double delta_t_k) {
  const auto found = std::find_if(contrasts.begin(), contrasts.end(),
                                  [&](const ContrastPrediction& c) { return c.delta_t_k == delta_t_k; });
  return found == contrasts.end() ? nullptr : &*found;
}

void use_thresholds(const std::vector<ExpectedThreshold>& known, ExperimentInputs& inputs) {
  for (ContrastOutlook& outlook : inputs.outlooks) {
    for (const ExpectedThreshold& threshold : known) {
      if (threshold.delta_t_k == outlook.delta_t_k && threshold.s75_mrad)
        outlook.s75_pitch = *threshold.s75_mrad / inputs.sensor.ifov_mrad();
    }
  }
}

std::vector<std::pair<int, double>> half_widths_by_frames(Plan plan, const ExperimentInputs& inputs) {
  std::vector<std::pair<int, double>> out;
  if (chosen_answers(plan, inputs.sensor).kind == AnswerKind::binary) return out;
  for (const int frames : frame_choices) {
    plan.schedule.frames_per_presentation = {frames};
    const auto predicted = predict_plan(plan, inputs);
    if (predicted && predicted->figures.predicted_uncertainty_percent)
      out.emplace_back(frames, *predicted->figures.predicted_uncertainty_percent);
  }
  return out;
}

}  // namespace

Result<std::vector<ExpectedThreshold>> expected_thresholds(const Plan& plan, ExperimentInputs inputs,
                                                           std::stop_token stop) {
  TODBENCH_TRY_VOID(refine_thresholds(inputs, plan.seed, std::move(stop)));
  std::vector<ExpectedThreshold> out;
  for (const double contrast : plan.target.delta_t_k) {
    ExpectedThreshold expected{.delta_t_k = contrast, .s75_mrad = {}};
    for (const ContrastOutlook& outlook : inputs.outlooks) {
      if (outlook.delta_t_k == contrast) expected.s75_mrad = outlook.s75_pitch * inputs.sensor.ifov_mrad();
    }
    out.push_back(expected);
  }
  return out;
}

TodCurve as_curve(const std::vector<ExpectedThreshold>& expected) {
  TodCurve curve;
  for (const auto& e : expected) {
    TodPoint point;
    point.set_delta_t_k = point.delta_t_k = e.delta_t_k;
    point.fit.threshold = e.s75_mrad;
    curve.points.push_back(std::move(point));
  }
  return curve;
}

Result<PlanForecast> forecast(const LoadedPlan& loaded, const std::vector<ExpectedThreshold>& known,
                              EffectPlanner& planner, std::stop_token stop) {
  const Plan& plan = loaded.plan();
  PlanForecast out;
  out.plan = plan;
  TODBENCH_TRY(auto inputs, experiment_inputs(loaded, planner));
  use_thresholds(known, inputs);
  out.frames = with_frames(plan, inputs).schedule.frames_per_presentation;
  auto prediction = predict_plan(plan, inputs);
  // Effects are planned even if the simulation cannot meet the tolerance.
  out.warnings = prediction ? prediction->warnings : inputs.warnings;
  if (std::string advice = ramp_advice(plan, inputs); !advice.empty()) out.warnings.push_back(std::move(advice));
  if (prediction) {
    if (auto timed = predict_times(plan, inputs, *prediction, stop);
        !timed && timed.error().code == ErrorCode::interrupted)
      return tl::unexpected(timed.error());
    out.twin = std::move(prediction->contrasts);
    out.runs = std::move(prediction->runs);
    out.twin_s = prediction->figures.predicted_s;
  } else {
    out.problem = prediction.error().message;
  }
  out.effects = inputs.effects;
  if (!plan.camera.id.empty() && plan.target.kind != TargetKind::scene) {
    if (auto bill = bill_forecast(plan, inputs)) out.bill = *std::move(bill);
  }
  if (out.problem.empty() && plan.simulation.phases == plan.target.phases) {
    out.camera = out.twin;
    out.by_frames = half_widths_by_frames(plan, inputs);
    return out;
  }
  Plan camera = plan;
  camera.simulation.phases = plan.target.phases;
  // Limits of the simulation do not apply to the camera.
  camera.simulation.accuracy = "draft";
  TODBENCH_TRY(inputs.accuracy, accuracy_of(camera));
  if (auto seen = predict_plan(camera, inputs)) {
    out.camera = std::move(seen->contrasts);
    out.runs = std::move(seen->runs);
  }
  out.by_frames = half_widths_by_frames(camera, inputs);
  return out;
}

std::optional<double> PlanPreview::uncertainty_percent() const {
  double largest = 0;
  for (const auto& contrast : contrasts) {
    if (!contrast.camera_uncertainty_percent) return std::nullopt;
    largest = std::max(largest, *contrast.camera_uncertainty_percent);
  }
  return contrasts.empty() ? std::nullopt : std::optional(largest);
}

PlanPreview outlook(const Plan& plan, const std::vector<TargetPlate>& plates, const PlanForecast* seen,
                    double frame_rate_hz) {
  PlanPreview out;
  const bool adaptive = plan.schedule.kind == ScheduleKind::adaptive;
  const std::vector<AdaptiveRun> runs =
      seen != nullptr && same_visits(plan, seen->plan) ? seen->runs : std::vector<AdaptiveRun>{};
  Plan timed = plan;
  if (seen != nullptr && plan.schedule == seen->plan.schedule && plan.target.delta_t_k == seen->plan.target.delta_t_k)
    timed.schedule.frames_per_presentation = seen->frames;
  const std::vector<TargetState> listed = listed_presentations(timed, plates);
  const BenchTime bench = bench_time(timed, plates, listed, frame_rate_hz, runs);
  out.presentations = bench.presentations;
  out.bench_s = bench.total_s();
  const double per_presentation = plates.empty() ? 0 : triangles_of(plates) / static_cast<double>(plates.size());
  out.trials = static_cast<std::uint64_t>(std::llround(static_cast<double>(bench.presentations) * per_presentation));
  const auto scaled = [&](const ContrastPrediction* c, int from, int phases) -> std::optional<double> {
    if (c == nullptr) return std::nullopt;
    return adaptive ? c->uncertainty_percent : rescaled_percent(c->uncertainty_percent, from, phases);
  };
  for (const double contrast : plan.target.delta_t_k) {
    PlannedContrast entry;
    entry.delta_t_k = contrast;
    if (seen != nullptr) {
      const ContrastPrediction *camera = at(seen->camera, contrast), *twin = at(seen->twin, contrast);
      if (camera != nullptr) entry.s75_mrad = camera->s75_mrad;
      entry.camera_uncertainty_percent = scaled(camera, seen->plan.target.phases, plan.target.phases);
      entry.twin_uncertainty_percent = scaled(twin, seen->plan.simulation.phases, plan.simulation.phases);
    }
    out.contrasts.push_back(entry);
  }
  if (seen != nullptr) {
    for (const auto& [frames, percent] : seen->by_frames) {
      timed.schedule.frames_per_presentation = {frames};
      const auto here = rescaled_percent(percent, seen->plan.target.phases, plan.target.phases);
      const double seconds = bench_time(timed, plates, listed, frame_rate_hz, runs).total_s();
      if (here) out.by_frames.emplace_back(seconds, *here);
    }
  }
  if (seen != nullptr && seen->twin_s && seen->plan.simulation.phases > 0) {
    const double ratio = static_cast<double>(plan.simulation.phases) / seen->plan.simulation.phases;
    out.twin_s = *seen->twin_s * (adaptive ? 1 : ratio);
  }
  return out;
}

Plan with_tolerance(Plan plan, const PlanForecast* seen, double tolerance_percent) {
  plan.simulation.tolerance_percent = tolerance_percent;
  if (plan.schedule.kind == ScheduleKind::adaptive) {
    plan.schedule.half_width_percent = tolerance_percent;
    return plan;
  }
  if (seen == nullptr) return plan;
  double needed = 0;
  for (const auto& contrast : seen->camera) {
    if (!contrast.uncertainty_percent) continue;
    const double ratio = std::log1p(*contrast.uncertainty_percent / 100) / std::log1p(tolerance_percent / 100);
    needed = std::max(needed, seen->plan.target.phases * ratio * ratio);
  }
  if (!(needed > 0)) return plan;
  // Rounding of the ratio must not cost a phase.
  const double whole = std::clamp(std::ceil(needed * (1 - 1e-9)), double{least_phases}, double{most_phases});
  plan.target.phases = plan.simulation.phases = static_cast<int>(whole);
  return plan;
}

std::vector<AccuracyPrice> accuracy_prices(const LoadedPlan& loaded, const PlanForecast& seen,
                                           const std::vector<ExpectedThreshold>& known, double frame_rate_hz,
                                           EffectPlanner& planner, const std::stop_token& stop) {
  std::vector<AccuracyPrice> prices;
  for (const double tolerance : {0.5, 1.0, 2.0, 3.0, 5.0, 7.5, 10.0, 20.0}) {
    if (stop.stop_requested()) break;
    const auto at = loaded.with(with_tolerance(loaded.plan(), &seen, tolerance));
    if (!at) continue;
    const Plan& priced = at->plan();
    auto inputs = experiment_inputs(*at, planner);
    if (!inputs) continue;
    use_thresholds(known, *inputs);
    auto found = predict_plan(priced, *inputs);
    if (found && !predict_times(priced, *inputs, *found, stop) && stop.stop_requested()) break;
    PlanForecast at_tolerance = seen;
    at_tolerance.twin_s.reset();
    if (found) {
      at_tolerance.plan = priced;
      at_tolerance.camera = at_tolerance.twin = found->contrasts;
      at_tolerance.twin_s = found->figures.predicted_s;
    }
    const PlanPreview out = outlook(priced, loaded.plates(), &at_tolerance, frame_rate_hz);
    const auto reached = out.uncertainty_percent();
    if (!reached || *reached > tolerance * (1 + 1e-6)) continue;
    prices.push_back({tolerance, priced.target.phases, out.bench_s, out.twin_s});
  }
  return prices;
}

Plot accuracy_plot(const std::vector<AccuracyPrice>& prices, const PlanPreview& now) {
  Plot plot;
  plot.id = "accuracy-time";
  plot.title = "Accuracy against time";
  plot.x = {.label = "Time (s)", .scale = AxisScale::logarithmic, .low = 1, .high = 10, .ticks = {}};
  plot.y = {.label = "Uncertainty (± %)", .scale = AxisScale::logarithmic, .low = 0.4, .high = 25, .ticks = {}};
  PlotSeries bench{.label = "bench", .tone = PlotTone::first, .line = PlotLine::solid, .points = {}};
  PlotSeries twin{
      .label = "twin", .tone = PlotTone::second, .marker = PlotMarker::square, .line = PlotLine::dashed, .points = {}};
  PlotSeries plan{.label = "plan", .tone = PlotTone::third, .marker = PlotMarker::bar, .points = {}};
  std::vector<double> times;
  const auto add = [&](PlotSeries& series, std::optional<double> seconds, std::optional<double> percent) {
    if (!seconds || !percent || !(*seconds > 0) || !(*percent > 0)) return;
    series.points.push_back({.x = *seconds, .y = *percent, .x_interval = {}, .y_interval = {}});
    times.push_back(*seconds);
    plot.y.low = std::min(plot.y.low, *percent / 1.2);
    plot.y.high = std::max(plot.y.high, *percent * 1.2);
  };
  for (const auto& price : prices) {
    add(bench, price.bench_s, price.tolerance_percent);
    add(twin, price.twin_s, price.tolerance_percent);
  }
  PlotSeries frames{.label = "1, 2, 4, 8 frames", .tone = PlotTone::third, .line = PlotLine::dotted, .points = {}};
  for (const auto& [seconds, percent] : now.by_frames) add(frames, seconds, percent);
  add(plan, now.bench_s, now.uncertainty_percent());
  add(plan, now.twin_s, now.uncertainty_percent());
  if (times.empty()) return plot;
  const auto [low, high] = std::minmax_element(times.begin(), times.end());
  plot.x.low = *low / 1.4;
  plot.x.high = *high * 1.4;
  plot.series = {bench, twin, frames, plan};
  return plot;
}

}  // namespace todbench
