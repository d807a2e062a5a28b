#include "bench/run/experiment.h"

#include <chrono>
#include <cmath>

#include "bench/report/report.h"
#include "bench/run/report_data.h"
#include "bench/session/descriptions.h"
#include "sim_devices/prediction/contrast_response.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "tod/measurement.h"

namespace todbench {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Everything that a plan names, read once.
struct Inputs {
  std::vector<TargetPlate> plates;
  TemplateObserverSpec observer;
  SensorSpec sensor;
  SensorPlan effects;
  Accuracy accuracy;
};

Result<Inputs> read_inputs(const Plan& plan) {
  Inputs inputs;
  auto plates = plates_of(plan);
  if (!plates) return tl::unexpected(plates.error());
  inputs.plates = std::move(*plates);
  auto observer = load_observer(plan.observer);
  if (!observer) return tl::unexpected(observer.error());
  inputs.observer = *observer;
  auto sensor = sensor_of(plan);
  if (!sensor) return tl::unexpected(sensor.error());
  inputs.sensor = *sensor;
  inputs.effects = full_plan(inputs.sensor, plan.simulation.skip, plan.simulation.force);
  auto accuracy = accuracy_of(plan);
  if (!accuracy) return tl::unexpected(accuracy.error());
  inputs.accuracy = *accuracy;
  return inputs;
}

/// One run of the measurement into a trials file.
class Recorder {
 public:
  Recorder(SessionFolder& folder, const ExperimentListener& listener, std::stop_token stop)
      : folder_(folder), listener_(listener), forward_(std::move(stop), [this] { halt_.request_stop(); }) {}

  /// Trials reach the disk one by one. A disk that refuses stops the run with `io`.
  [[nodiscard]] Result<MeasurementResult> run(OpenedBench& bench, Observer& observer, TrialSchedule& schedule,
                                              const MeasurementOptions& options, SessionCurve which) {
    auto writer = folder_.open_trials(which);
    if (!writer) return tl::unexpected(writer.error());
    std::optional<Error> write_error;
    MeasurementListener events;
    events.on_trial = [&](const Trial& trial) {
      if (write_error) return;
      if (auto written = writer->append(trial); !written) {
        write_error = written.error();
        halt_.request_stop();
      }
    };
    events.on_progress = listener_.on_progress;
    events.on_note = [&](const std::string& sentence) {
      (void)folder_.log(sentence);
      if (listener_.on_note) listener_.on_note(sentence);
    };
    auto result = measure(*bench.camera, *bench.target, observer, schedule, options, events, halt_.get_token());
    if (auto synced = writer->sync(); !synced && !write_error) write_error = synced.error();
    if (write_error) {
      if (!result) return tl::unexpected(*write_error);
      result->ended_by = write_error;
    }
    return result;
  }

 private:
  SessionFolder& folder_;
  const ExperimentListener& listener_;
  std::stop_source halt_;
  std::stop_callback<std::function<void()>> forward_;
};

void phase(const ExperimentListener& listener, std::string_view text) {
  if (listener.on_phase) listener.on_phase(text);
}

/// What the contrast estimate reads of 1 K on each plate; the simulated sensor stands for the camera.
Result<std::map<std::string, double>> responses(const SensorModel& model, const Plan& plan,
                                                const std::vector<TargetPlate>& plates,
                                                const MeasurementOptions& options) {
  std::map<std::string, double> out;
  RegistrationOptions registration = options.registration;
  registration.expected_scale_px_per_mm =
      1 / (plan.target.distance_m * model.spec().ifov_mrad() / model.spec().microscan);
  for (const auto& plate : plates) {
    auto response = contrast_response(model, plate, plan.target.distance_m, options.min_reference_px, registration);
    if (!response) return tl::unexpected(response.error());
    out[plate.name] = *response;
  }
  return out;
}

/// The plan's own trial design on the simulated sensor.
struct TwinRun {
  MeasurementResult result;
  TodCurve curve;
  double wall_s = 0;
};

Result<TwinRun> run_simulated(const Plan& plan, const Inputs& inputs, SessionFolder& folder, SessionCurve which,
                              std::map<double, double> shown_delta_t_k, const ExperimentListener& listener,
                              std::stop_token stop) {
  const auto begin = Clock::now();
  const auto model = std::make_shared<const SensorModel>(inputs.sensor, inputs.effects, inputs.accuracy, plan.seed);
  TemplateObserver observer(inputs.observer, triangle_alternatives());
  MeasurementOptions options =
      measurement_options(plan, inputs.plates, inputs.sensor.ifov_mrad() / inputs.sensor.microscan);
  options.samples_per_pitch = inputs.sensor.microscan;
  options.frames_after_change = 0;
  options.nuc_interval_s = 0;
  options.integrity.reject_frozen = inputs.effects.simulates(Effect::temporal_noise) && inputs.sensor.netd_k > 0;
  auto response = responses(*model, plan, inputs.plates, options);
  if (!response) return tl::unexpected(response.error());
  options.contrast_response = std::move(*response);
  OpenedBench bench = simulated_bench(model, inputs.plates, plan.target.distance_m, std::move(shown_delta_t_k));
  ListedSchedule schedule(
      constant_stimuli(stimuli_options(plan, inputs.plates, inputs.sensor.ifov_mrad(), Side::simulated),
                       RandomStream(plan.seed, "schedule.simulated")));
  auto result = Recorder(folder, listener, stop).run(bench, observer, schedule, options, which);
  if (!result) return fail("simulating", result.error());
  TwinRun run{.result = std::move(*result), .curve = {}, .wall_s = 0};
  auto curve = tod_curve(run.result.trials, fit_options(plan));
  if (!curve) return tl::unexpected(curve.error());
  run.curve = std::move(*curve);
  run.curve.sensor = inputs.sensor.name;
  run.curve.observer = inputs.observer.name;

  std::vector<double> contrasts;
  for (const auto& point : run.curve.points) contrasts.push_back(point.delta_t_k);
  if (!run.result.ended_by) {
    auto direct = direct_estimate(
        inputs.sensor, inputs.effects, observer, contrasts,
        {.samples_per_pitch = inputs.sensor.microscan, .accuracy = inputs.accuracy, .seed = plan.seed, .stop = stop});
    if (!direct && direct.error().code == ErrorCode::interrupted) {
      run.result.ended_by = direct.error();
    } else if (!direct) {
      run.result.notes.push_back("no direct estimate: " + direct.error().message);
    } else {
      for (std::size_t i = 0; i < direct->size(); ++i) {
        run.curve.points[i].direct_s75_mrad = (*direct)[i].s75_pitch * inputs.sensor.ifov_mrad();
        run.curve.points[i].direct_s75_se_mrad = (*direct)[i].standard_error_pitch * inputs.sensor.ifov_mrad();
      }
    }
  }
  run.wall_s = seconds_since(begin);
  return run;
}

/// Writes report.html from what the folder holds.
Result<void> write_report_of(SessionFolder& folder) {
  auto session = read_session(folder.path());
  if (!session) return tl::unexpected(session.error());
  auto data = report_data(*session, folder.path().filename().string());
  if (!data) return tl::unexpected(data.error());
  return folder.write_report(render_report(*data));
}

/// Ends a session in good order whatever happened: report where there is a curve, provenance, manifest.
Result<void> close_session(SessionFolder& folder, const Provenance& provenance, const std::optional<Error>& ended_by) {
  if (ended_by) (void)folder.log("ended early: " + ended_by->message);
  const SessionState state = ended_by ? SessionState::interrupted : SessionState::complete;
  Provenance last = provenance;
  last.state = state;
  last.ended_utc = utc_now();
  if (auto written = folder.write_provenance(last); !written) return written;
  if (last.run) {
    if (auto written = write_report_of(folder); !written) return written;
  }
  return folder.finish(last, state);
}

Error with_context(std::string_view doing, const Error& error) {
  return {error.code, std::string(doing) + ": " + error.message};
}

/// The session is over before there is a curve: leave a valid folder, hand the reason on.
tl::unexpected<Error> abandon(SessionFolder& folder, Provenance provenance, Error error) {
  (void)close_session(folder, provenance, error);
  return tl::unexpected<Error>(std::move(error));
}

/// Why the interval of an outcome cannot be judged: an interrupted run passes nothing.
Verdict verdict_of(const Plan& plan, const ExperimentOutcome& outcome) {
  return judge(plan.limits, outcome.curve, outcome.comparison);
}

std::chrono::year_month_day today() {
  return std::chrono::floor<std::chrono::days>(std::chrono::system_clock::now());
}

}  // namespace

Result<ExperimentOutcome> simulate_plan(const Plan& plan, const ExperimentOptions& options,
                                        const ExperimentListener& listener, std::stop_token stop) {
  auto inputs = read_inputs(plan);
  if (!inputs) return tl::unexpected(inputs.error());
  auto folder = SessionFolder::create(options.folder, options.existing);
  if (!folder) return tl::unexpected(folder.error());
  if (auto written = folder->write_plan(plan); !written) return tl::unexpected(written.error());
  Provenance provenance = begin_provenance(plan, Side::simulated);
  provenance.effects = inputs->effects;
  provenance.target = "simulated scene";
  if (auto written = folder->write_provenance(provenance); !written) return tl::unexpected(written.error());

  phase(listener, "simulating " + inputs->sensor.name);
  auto run = run_simulated(plan, *inputs, *folder, SessionCurve::main, {}, listener, stop);
  if (!run) return abandon(*folder, provenance, run.error());
  provenance.run = run_record(run->result, run->wall_s);
  ExperimentOutcome outcome{.folder = folder->path(),
                            .curve = run->curve,
                            .twin = std::nullopt,
                            .comparison = std::nullopt,
                            .verdict = {},
                            .effects = inputs->effects,
                            .figures = figures_of(*provenance.run),
                            .ended_by = run->result.ended_by};
  outcome.verdict = verdict_of(plan, outcome);
  if (auto written = folder->write_curves(outcome.curve, std::nullopt, Side::simulated); !written)
    return tl::unexpected(written.error());
  if (auto closed = close_session(*folder, provenance, outcome.ended_by); !closed)
    return tl::unexpected(closed.error());
  return outcome;
}

Result<ExperimentOutcome> measure_plan(const Plan& plan, const ExperimentOptions& options,
                                       const ExperimentListener& listener, std::stop_token stop) {
  if (plan.camera.id.empty()) return fail(ErrorCode::invalid_input, "the plan names no camera: [camera] id is missing");
  if (auto valid = check_calibration(plan, today()); !valid) return tl::unexpected(valid.error());
  auto inputs = read_inputs(plan);
  if (!inputs) return tl::unexpected(inputs.error());
  auto folder = SessionFolder::create(options.folder, options.existing);
  if (!folder) return tl::unexpected(folder.error());
  if (auto written = folder->write_plan(plan); !written) return tl::unexpected(written.error());
  Provenance provenance = begin_provenance(plan, Side::measured);
  provenance.effects = inputs->effects;

  phase(listener, "opening " + plan.camera.id);
  auto bench = open_bench(plan, inputs->plates, stop);
  if (!bench) return abandon(*folder, provenance, bench.error());
  const SourceInfo info = bench->camera->info();
  provenance.camera = camera_record(info);
  provenance.target = bench->target->capabilities().description;
  for (const auto& warning : info.warnings) {
    (void)folder->log(warning);
    if (listener.on_note) listener.on_note(warning);
  }
  if (auto written = folder->write_provenance(provenance); !written) return tl::unexpected(written.error());

  const auto begin = Clock::now();
  TemplateObserver observer(inputs->observer, triangle_alternatives());
  MeasurementOptions measurement = measurement_options(plan, inputs->plates, plan.camera.ifov_mrad);
  const SensorModel model(inputs->sensor, inputs->effects, inputs->accuracy, plan.seed);
  auto response = responses(model, plan, inputs->plates, measurement);
  if (!response) return abandon(*folder, provenance, response.error());
  measurement.contrast_response = std::move(*response);
  ListedSchedule schedule(constant_stimuli(stimuli_options(plan, inputs->plates, plan.camera.ifov_mrad, Side::measured),
                                           RandomStream(plan.seed, "schedule")));
  phase(listener, "measuring " + info.model + " " + info.serial);
  auto result = Recorder(*folder, listener, stop).run(*bench, observer, schedule, measurement, SessionCurve::main);
  if (!result) return abandon(*folder, provenance, with_context("measuring", result.error()));
  provenance.run = run_record(*result, seconds_since(begin));
  bench->camera.reset();

  ExperimentOutcome outcome;
  outcome.folder = folder->path();
  outcome.effects = inputs->effects;
  outcome.figures = figures_of(*provenance.run);
  outcome.ended_by = result->ended_by;
  auto curve = tod_curve(result->trials, fit_options(plan));
  if (!curve) return abandon(*folder, provenance, curve.error());
  outcome.curve = std::move(*curve);
  outcome.curve.sensor = info.model + " " + info.serial;
  outcome.curve.observer = inputs->observer.name;

  if (!outcome.ended_by) {
    phase(listener, "simulating its twin " + inputs->sensor.name);
    std::map<double, double> shown;
    for (const auto& point : outcome.curve.points) shown[point.set_delta_t_k] = point.delta_t_k;
    auto twin = run_simulated(plan, *inputs, *folder, SessionCurve::twin, std::move(shown), listener, stop);
    if (!twin) return abandon(*folder, provenance, with_context("the simulated twin", twin.error()));
    provenance.twin_run = run_record(twin->result, twin->wall_s);
    outcome.ended_by = twin->result.ended_by;
    outcome.twin = std::move(twin->curve);
    auto comparison = compare(outcome.curve, *outcome.twin, comparison_options(plan));
    if (!comparison) return abandon(*folder, provenance, comparison.error());
    outcome.comparison = std::move(*comparison);
    if (auto written = folder->write_comparison(*outcome.comparison); !written) return tl::unexpected(written.error());
  }
  outcome.verdict = verdict_of(plan, outcome);
  if (auto written = folder->write_curves(outcome.curve, outcome.twin, Side::measured); !written)
    return tl::unexpected(written.error());
  if (auto closed = close_session(*folder, provenance, outcome.ended_by); !closed)
    return tl::unexpected(closed.error());
  return outcome;
}

}  // namespace todbench
