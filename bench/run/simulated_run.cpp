// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run/simulated_run.h"

#include <chrono>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/devices/bench_host.h"
#include "bench/run/fitted_curve.h"
#include "bench/run/trial_recorder.h"
#include "bench/twin/direct_results.h"
#include "bench/twin/module_chain.h"
#include "bench/twin/simulated_set_up.h"
#include "bench/twin/twin_shapes.h"
#include "tod/measurement/contrast_error.h"

namespace todbench {
namespace {

using Clock = std::chrono::steady_clock;

/// Makes the trials with the frames behind the modules and stages.
Result<MeasurementResult> simulated_trials(const Plan& plan, const ExperimentInputs& inputs, SimulatedSetUp& set_up,
                                           const OpenSession& open, SessionCurve which, const ExperimentHost& host,
                                           const ModuleLine& log_line, std::stop_token stop) {
  set_up.bench.host = bench_host({.pause = host.pause});
  const auto modules = picture_modules(plan, inputs.sensor, Side::simulated);
  put_behind(set_up.bench, modules, host.added, log_line, set_up.options);
  if (!modules.empty() || host.added.make)
    set_up.options.frames_after_change = settle_frames(modules) + host.added.memory_frames;
  const auto observer = observer_of(plan, inputs, log_line);
  return record_trials(open, set_up.bench, *observer, *set_up.schedule, set_up.options, which, AnswerKind::graded,
                       std::move(stop));
}

/// Adds the estimate without trials to the curve.
void add_direct(SimulatedRun& run, const Plan& plan, const ExperimentInputs& inputs,
                const std::map<double, double>& shown_delta_t_k, const OpenSession& open, std::stop_token stop) {
  phase(open.folder, open.listener, "estimating " + inputs.sensor.name + " directly");
  DirectResults direct = direct_results(run.curve, inputs, shown_delta_t_k, plan.seed, std::move(stop));
  run.result.ended_by = std::move(direct.ended_by);
  for (auto& sentence : direct.notes) {
    note(open.folder, open.listener, sentence);
    run.result.notes.push_back(std::move(sentence));
  }
  keep_direct(direct, inputs.sensor.ifov_mrad(), run.curve);
}

/// The curve of the trials, with what the run says about each point.
Result<TodCurve> simulated_curve(const MeasurementResult& result, std::span<const Trial> trials, const Plan& plan,
                                 const ExperimentInputs& inputs) {
  auto curve = tod_curve(trials, fit_options(plan));
  // Report the reason of the early end rather than that its few trials make no curve.
  if (!curve) return tl::unexpected(result.ended_by.value_or(curve.error()));
  add_contrast_errors(*curve, result.contrasts);
  curve->sensor = inputs.sensor.name;
  curve->observer = observer_name(plan, inputs);
  keep_noise(result, *curve);
  for (auto& point : curve->points) {
    if (!result.judged_contrasts.empty() || sensor_module(inputs.sensor) != nullptr) continue;
    // Noise of the complete sensor: if the planner skips noise, the counts are not representative.
    point.noise_counts = inputs.stated_noise_counts;
  }
  return curve;
}

}  // namespace

Result<SimulatedRun> run_simulated(const Plan& plan, const ExperimentInputs& inputs, const OpenSession& open,
                                   SessionCurve which, const FromCamera& camera, const ExperimentHost& host,
                                   std::stop_token stop) {
  const auto begin = Clock::now();
  const std::map<double, double>& shown_delta_t_k = camera.shown_delta_t_k;
  const ModuleLine log_line = module_log(open.folder);
  TODBENCH_TRY(auto set_up,
               simulated_set_up(plan, inputs, shown_delta_t_k, stop,
                                {.on_error_line = log_line, .dither = host.added.dither}, camera.responses));
  auto result = simulated_trials(plan, inputs, set_up, open, which, host, log_line, stop);
  if (!result) return fail("simulating", result.error());
  SimulatedRun run{.result = std::move(*result), .curve = {}, .wall_s = 0};
  const FittedTrials to_fit = trials_to_fit(run.result, plan, inputs, stop);
  if (to_fit.failed) run.result.ended_by = to_fit.failed;
  TODBENCH_TRY(run.curve, simulated_curve(run.result, to_fit.of(run.result), plan, inputs));

  const TodCurve stopped_by = known_functions(set_up.functions, run.curve);
  report_fit(run.result, plan, inputs, open);
  TwinShapesOutcome shaped =
      take_shape(run.curve, to_fit.of(run.result), !run.result.ended_by, plan, inputs, shown_delta_t_k,
                 stopped_by.points.empty() ? camera.functions : &stopped_by, stop);
  const auto of_ramp = take_ramp_of(run.curve, shaped, run.result, to_fit, plan);
  keep_shape(run.result, shaped, open);
  if (!run.result.ended_by && (has_modules(plan, inputs.sensor) || host.added.make)) {
    const std::string sentence =
        std::string("no direct estimate: it would not include the ") + (host.added.make ? "package" : "modules");
    note(open.folder, open.listener, sentence);
    run.result.notes.push_back(sentence);
  } else if (!run.result.ended_by) {
    add_direct(run, plan, inputs, shown_delta_t_k, open, std::move(stop));
  }
  examine_all(run.curve, plan, of_ramp);
  run.wall_s = std::chrono::duration<double>(Clock::now() - begin).count();
  return run;
}

}  // namespace todbench
