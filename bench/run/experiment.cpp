// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run/experiment.h"

#include <chrono>
#include <memory>
#include <utility>

#include "acquisition/base/host_clock.h"
#include "acquisition/base/try.h"
#include "acquisition/core/camera_id.h"
#include "acquisition/recording/frame_stream.h"
#include "bench/devices/observed_source.h"
#include "bench/forecast/bench_time.h"
#include "bench/forecast/bill_forecast.h"
#include "bench/forecast/comparison_forecast.h"
#include "bench/forecast/ramp_advice.h"
#include "bench/judgement/run_findings.h"
#include "bench/run/fitted_curve.h"
#include "bench/run/grey_results.h"
#include "bench/run/measured_run.h"
#include "bench/run/physical_measures.h"
#include "bench/run/recorded_bench.h"
#include "bench/run/session_end.h"
#include "bench/run/simulated_run.h"
#include "bench/run/twin_results.h"
#include "bench/twin/acuity_limits.h"
#include "bench/twin/background_twin_functions.h"
#include "bench/twin/camera_surrogate.h"
#include "bench/twin/experiment_inputs.h"
#include "bench/twin/module_chain.h"

namespace todbench {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::chrono::year_month_day today() {
  return std::chrono::floor<std::chrono::days>(std::chrono::system_clock::now());
}

/// Rejects a tolerance beyond the hard caps before anything is simulated or moved.
Result<void> check_tolerance(const Plan& plan, const ExperimentInputs& inputs) {
  if (has_modules(plan, inputs.sensor)) return {};
  TODBENCH_TRY_VOID(predict_plan(plan, inputs));
  return {};
}

/// Whether the times of the run are comparable with the forecast of its plan: not of a run that ended early, of a
/// simulated scene, nor of recorded frames, whose presentations were before the run. `begin_ns`: start of the run, on
/// the clock of the presentations.
bool has_times_of_plan(const MeasurementResult& result, double wall_s, std::int64_t begin_ns) {
  const auto& shown = result.presentations;
  if (result.ended_by || shown.empty() || !shown.front().host_time_ns || !shown.back().host_time_ns) return false;
  const double span_s = static_cast<double>(*shown.back().host_time_ns - *shown.front().host_time_ns) * 1e-9;
  return *shown.front().host_time_ns >= begin_ns && span_s <= wall_s;
}

/// Adds what stands beside the results for an observer with an eye. Without it the session is complete, too.
void add_display(ExperimentOutcome& outcome, Provenance& provenance, const Plan& plan, const ExperimentInputs& inputs,
                 const OpenSession& open, const std::stop_token& stop) {
  if (outcome.ended_by || !(inputs.observer.eye || plan.display_as_operator)) return;
  phase(open.folder, open.listener, "estimating what limits the acuity");
  auto found = at_display(outcome.curve, inputs, plan, stop);
  if (found) {
    outcome.at_display = provenance.at_display = *std::move(found);
  } else if (found.error().code == ErrorCode::interrupted) {
    outcome.ended_by = found.error();
  } else {
    note(open.folder, open.listener, "no limits of the acuity: " + found.error().message);
  }
}

/// Creates the folder and reports it, with all that is known before the first frame.
Result<SessionFolder> opened_session(const LoadedPlan& chosen, const ExperimentOptions& options, Provenance& provenance,
                                     const ExperimentListener& listener) {
  auto folder = begin_session(chosen, options, provenance);
  if (!folder) return folder;
  if (listener.on_session) listener.on_session(folder->path());
  note_failed_selftest({*folder, listener}, provenance);
  return folder;
}

/// Rejects a plan that the camera or its twin cannot carry out, before anything is moved.
Result<void> check_bench(const Plan& plan, const ExperimentInputs& inputs, const SourceInfo& info) {
  TODBENCH_TRY_VOID(check_contrast_of(plan, inputs, info));
  if (auto fits = check_measured_geometry(plan, inputs, {info.width, info.height}); !fits) return fits;
  if (auto fits = check_simulated_geometry(plan, inputs); !fits) return fail("the simulated twin", fits.error());
  return {};
}

/// What a run has before its first presentation.
struct RunStart {
  std::shared_ptr<FrameStreamWriter> recording{};  ///< null: frames are not recorded
  std::vector<std::string> notes{};
};

/// Waits for the warm-up, begins the recording, and predicts the comparison and the ways to measure a ramp's contrasts.
Result<RunStart> start_run(const Plan& plan, const ExperimentInputs& inputs, OpenedBench& bench,
                           const AddedStages& added, const OpenSession& open, const std::stop_token& stop) {
  RunStart start;
  if (plan.camera.warm_up.stated() && !added.as_recorded) {
    phase(open.folder, open.listener, "waiting until " + bench.camera->info().model + " is warm");
    auto warm = warmed_up(*bench.camera, plan, stop);
    if (!warm) return tl::unexpected(with_context("warm-up", warm.error()));
    note(open.folder, open.listener, *warm);
    start.notes.push_back(*std::move(warm));
  }
  if (plan.measurement.record_frames) {
    TODBENCH_TRY(start.recording, record_bench(bench, open.folder.path()));
  }
  // The prediction does not include a package.
  const auto prediction = predict_plan(plan, inputs);
  const std::string forecast = prediction && !added.make ? comparison_forecast(plan, *prediction).sentence : "";
  const std::string advice = added.as_recorded ? "" : ramp_advice(plan, inputs);
  for (const std::string& sentence : {advice, forecast}) {
    if (sentence.empty()) continue;
    note(open.folder, open.listener, sentence);
    start.notes.insert(start.notes.begin(), sentence);
  }
  return start;
}

/// Starts the comparison by pairs; null if the run ended early or the plan requests none. Borrowed objects outlive it.
std::unique_ptr<BackgroundTask<Pairs>> start_pairs(const MeasurementResult& result, const FittedTrials& to_fit,
                                                   BackgroundTask<FittedCurve>& fit, const Plan& plan,
                                                   const ExperimentInputs& inputs) {
  if (result.ended_by) return nullptr;
  const auto camera_of = [&result, &to_fit, &fit](std::stop_token halt) {
    const FittedCurve& made = fit.get(std::move(halt));
    return PairedCamera{made.curve,    result.trials,    result.set_ups, made.by_twin ? &*made.by_twin : nullptr,
                        &made.model_u, to_fit.of(result)};
  };
  return pairs_in_background(camera_of, plan, inputs);
}

/// Takes the presentations of `result`.
ExperimentOutcome outcome_of(const OpenSession& open, TodCurve curve, MeasurementResult& result,
                             std::optional<CameraMeasures> measures, const ExperimentInputs& inputs,
                             const RunRecord& run) {
  return {.folder = open.folder.path(),
          .curve = std::move(curve),
          .twin = std::nullopt,
          .comparison = std::nullopt,
          .verdict = {},
          .measures = std::move(measures),
          .effects = inputs.effects,
          .figures = figures_of(run),
          .ended_by = result.ended_by,
          .presentations = std::move(result.presentations)};
}

}  // namespace

Result<ExperimentOutcome> simulate_plan(const Plan& plan, const ExperimentOptions& options,
                                        const ExperimentListener& listener, std::stop_token stop) {
  TODBENCH_TRY(const auto loaded, LoadedPlan::load(plan));
  return simulate_plan(loaded, options, listener, std::move(stop));
}

Result<ExperimentOutcome> simulate_plan(const LoadedPlan& loaded, const ExperimentOptions& options,
                                        const ExperimentListener& listener, std::stop_token stop) {
  EffectPlanner planner;
  TODBENCH_TRY(auto inputs, experiment_inputs(loaded, planner));
  TODBENCH_TRY(const auto chosen, loaded.with(with_frames(with_limits_in_ramp(loaded.plan()), inputs)));
  const Plan& plan = chosen.plan();
  Provenance provenance = begin_provenance(plan, Side::simulated);
  provenance.effects = inputs.effects;
  provenance.modules = module_records(plan, inputs.sensor, Side::simulated);
  provenance.target = "simulated scene";
  TODBENCH_TRY_VOID(check_simulated_geometry(plan, inputs));
  TODBENCH_TRY_VOID(check_tolerance(plan, inputs));
  TODBENCH_TRY(auto folder, opened_session(chosen, options, provenance, listener));
  const OpenSession open{folder, listener};
  for (const auto& warning : inputs.warnings) note(folder, listener, warning);
  phase(folder, listener, "simulating " + inputs.sensor.name);
  auto run = run_simulated(plan, inputs, open, SessionCurve::main, {}, options.host, stop);
  if (!run) {
    // At contrasts below the threshold the plate may not be found either: report the cause, not the symptom.
    if (!inputs.identifiable && run.error().code == ErrorCode::calibration)
      return abandon(open, plan, provenance,
                     {ErrorCode::not_identifiable, inputs.warnings.front() + "; " + run.error().message});
    return abandon(open, plan, provenance, run.error());
  }
  std::optional<CameraMeasures> measures;
  const auto begin = Clock::now();
  if (!run->result.ended_by) {
    auto found = simulated_measures(loaded, inputs, open, stop);
    if (found)
      measures = *std::move(found);
    else
      run->result.ended_by = found.error();
  }
  run->result.notes.insert(run->result.notes.end(), inputs.warnings.begin(), inputs.warnings.end());
  const double measures_s = plan.measures.any() ? seconds_since(begin) : 0;
  provenance.run = run_record(run->result, run->wall_s + measures_s);
  provenance.run->measures_s = measures_s;
  ExperimentOutcome outcome =
      outcome_of(open, std::move(run->curve), run->result, std::move(measures), inputs, *provenance.run);
  add_display(outcome, provenance, plan, inputs, open, stop);
  return concluded(std::move(outcome), plan, open, provenance);
}

Result<ExperimentOutcome> measure_plan(const Plan& plan, const ExperimentOptions& options,
                                       const ExperimentListener& listener, std::stop_token stop) {
  TODBENCH_TRY(const auto loaded, LoadedPlan::load(plan));
  return measure_plan(loaded, options, listener, std::move(stop));
}

Result<ExperimentOutcome> measure_plan(const LoadedPlan& loaded, const ExperimentOptions& options,
                                       const ExperimentListener& listener, std::stop_token stop) {
  const Plan& plan = loaded.plan();
  if (plan.camera.id.empty()) return fail(ErrorCode::invalid_input, "the plan names no camera: [camera] id is missing");
  TODBENCH_TRY_VOID(check_calibration(plan, today()));
  EffectPlanner planner;
  TODBENCH_TRY(auto inputs, experiment_inputs(loaded, planner));
  TODBENCH_TRY_VOID(check_tolerance(plan, inputs));
  if (listener.on_phase) listener.on_phase("opening " + plan.camera.id);
  TODBENCH_TRY(auto bench, open_bench(loaded, stop, options.host, listener.on_phase, listener.on_wait));
  if (options.host.on_opened) {
    TODBENCH_TRY(std::string note_of_session, options.host.on_opened(bench));
    inputs.warnings.push_back(std::move(note_of_session));
  }
  return measure_on_bench(loaded, inputs, std::move(bench), options, listener, std::move(stop));
}

namespace {

/// Notes the changes of the camera that the run could not show.
void note_unchecked_changes(MeasurementResult& result, const OpenSession& open) {
  const std::string sentence = result.ended_by ? "" : unchecked_changes(result.contrasts, result.constancy);
  if (sentence.empty()) return;
  note(open.folder, open.listener, sentence);
  result.notes.push_back(sentence);
}

}  // namespace

Result<ExperimentOutcome> measure_on_bench(const LoadedPlan& loaded, const ExperimentInputs& inputs, OpenedBench bench,
                                           const ExperimentOptions& options, const ExperimentListener& listener,
                                           std::stop_token stop) {
  TODBENCH_TRY(const auto chosen, loaded.with(with_frames(with_limits_in_ramp(loaded.plan()), inputs)));
  const Plan& plan = chosen.plan();
  if (listener.on_open) listener.on_open(bench.camera->info());
  if (listener.on_frame) bench.camera = observed_source(std::move(bench.camera), listener.on_frame);
  const SourceInfo info = bench.camera->info();
  TODBENCH_TRY_VOID(check_bench(plan, inputs, info));
  Provenance provenance = begin_provenance(plan, Side::measured);
  provenance.effects = inputs.effects;
  provenance.modules = module_records(plan, inputs.sensor, Side::simulated);
  provenance.camera = camera_record(info);
  provenance.target = bench.target->capabilities().description;
  provenance.origin = options.origin;
  TODBENCH_TRY(auto folder, opened_session(chosen, options, provenance, listener));
  const OpenSession open{folder, listener};
  for (const auto& warning : info.warnings) note(folder, listener, warning);
  for (const auto& warning : bench.warnings) note(folder, listener, warning);
  for (const auto& warning : inputs.warnings) note(folder, listener, warning);
  auto start = start_run(plan, inputs, bench, options.host.added, open, stop);
  if (!start) return abandon(open, plan, provenance, start.error());

  // Made before the run: the report states how good it was.
  auto forecast = bill_forecast(plan, inputs);
  if (forecast && !options.host.added.as_recorded && !has_scheme(plan.camera.id, camera_scheme::file)) {
    if (const std::string remark = resume_remark(plan, forecast->total_s); !remark.empty())
      note(folder, listener, remark);
  }

  const auto begin = Clock::now();
  const std::int64_t begin_ns = monotonic_ns();
  phase(folder, listener, "measuring " + info.model + " " + info.serial);
  auto responses = responses_of_camera(plan, inputs, stop);
  if (!responses) return abandon(open, plan, provenance, with_context("measuring", responses.error()));
  std::optional<BackgroundTwinFunctions> functions;
  if (plan.schedule.kind != ScheduleKind::adaptive) functions.emplace(plan, inputs);
  BackgroundMeasures twin_measures(loaded, inputs);
  CameraSurrogate surrogate(chosen, inputs, *responses);
  auto measured = run_measured(plan, inputs, surrogate, bench, open, options.host.added, stop);
  if (!measured) return abandon(open, plan, provenance, with_context("measuring", measured.error()));
  MeasurementResult& result = measured->result;
  result.notes.insert(result.notes.end(), inputs.warnings.begin(), inputs.warnings.end());
  result.notes.insert(result.notes.end(), start->notes.begin(), start->notes.end());
  provenance.camera_optics = surrogate.record();
  if (const auto sentence = surrogate.sentence()) {
    note(folder, listener, *sentence);
    result.notes.push_back(*sentence);
  }
  const auto lent = surrogate.lent();
  const FittedTrials to_fit = trials_to_fit(result, plan, lent ? *lent : inputs, stop);
  if (to_fit.failed) result.ended_by = to_fit.failed;
  auto curve = curve_of_camera(result, to_fit.of(result), plan, inputs, info, open);
  if (!curve) {
    provenance.run = run_record(result, seconds_since(begin));
    return abandon(open, plan, provenance, curve.error());
  }
  const auto fit = fit_in_background(*std::move(curve), *measured, to_fit, plan, inputs,
                                     functions ? &*functions : nullptr, surrogate);
  const auto pairs = start_pairs(result, to_fit, *fit, plan, inputs);
  auto measures = measures_of_camera(*measured, plan, inputs, bench, start->recording.get(), open, stop);
  bench = {};
  report_fit(result, plan, inputs, open);
  const FittedCurve& fitted = fit->get(stop);
  keep_shape(result, fitted.said, open);
  note_unchecked_changes(result, open);
  const double wall_s = seconds_since(begin);
  if (forecast && has_times_of_plan(result, wall_s, begin_ns)) provenance.forecast = time_forecast(*forecast);
  if (provenance.forecast) {
    const auto sentence = forecast_and_outcome(accuracy_bill({.presentations = result.presentations,
                                                              .curve = fitted.curve,
                                                              .effects = inputs.effects,
                                                              .wall_s = wall_s,
                                                              .measures_s = measured->measures_s,
                                                              .forecast = &*provenance.forecast}));
    note(folder, listener, sentence);
    result.notes.push_back(sentence);
  }
  provenance.run = run_record(result, wall_s);
  provenance.run->measures_s = measured->measures_s;
  ExperimentOutcome outcome = outcome_of(open, fitted.curve, result, std::move(measures), inputs, *provenance.run);
  outcome.forecast = provenance.forecast;
  if (!outcome.ended_by) {
    FromCamera camera{.curve = &fitted.curve,
                      .functions = &fitted.functions_of_twin(),
                      .shown_delta_t_k = contrasts_seen(fitted.curve)};
    if (plan.camera.contrast == ContrastUnit::kelvin) camera.responses = *responses;
    add_twin(outcome, provenance, camera, loaded, with_settled_contrasts(plan), inputs, {pairs.get(), twin_measures},
             options.host, open, stop);
  }
  add_display(outcome, provenance, plan, inputs, open, stop);
  return concluded(std::move(outcome), plan, open, provenance);
}

}  // namespace todbench
