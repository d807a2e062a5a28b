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

void phase(SessionFolder& folder, const ExperimentListener& listener, const std::string& text) {
  (void)folder.log(text);
  if (listener.on_phase) listener.on_phase(text);
}

void note(SessionFolder& folder, const ExperimentListener& listener, const std::string& sentence) {
  (void)folder.log(sentence);
  if (listener.on_note) listener.on_note(sentence);
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
    events.on_note = [&](const std::string& sentence) { note(folder_, listener_, sentence); };
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

/// What the contrast estimate reads of 1 K on each plate; the simulated sensor stands for the camera.
Result<std::map<std::string, double>> responses(const SensorModel& model, const Plan& plan,
                                                const std::vector<TargetPlate>& plates,
                                                const MeasurementOptions& options, std::stop_token stop) {
  std::map<std::string, double> out;
  RegistrationOptions registration = options.registration;
  registration.expected_scale_px_per_mm =
      1 / (plan.target.distance_m * model.spec().ifov_mrad() / model.spec().microscan);
  for (const auto& plate : plates) {
    auto response =
        contrast_response(model, plate, plan.target.distance_m, options.min_reference_px, registration, stop);
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
  auto response = responses(*model, plan, inputs.plates, options, stop);
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

Error with_context(std::string_view doing, const Error& error) {
  return {error.code, std::string(doing) + ": " + error.message};
}

/// Writes report.html from what the folder holds.
Result<void> write_report_of(SessionFolder& folder) {
  auto session = read_session(folder.path());
  if (!session) return tl::unexpected(session.error());
  auto data = report_data(*session, session_name(folder.path()));
  if (!data) return tl::unexpected(data.error());
  return folder.write_report(render_report(*data));
}

/// Ends a session in good order whatever happened: report where there is a run, provenance, manifest.
Result<void> close_session(SessionFolder& folder, const Provenance& provenance, const std::optional<Error>& ended_by) {
  (void)folder.log(ended_by ? "ended early: " + ended_by->message : "complete");
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

/// The session is over before there is a curve: leave a valid folder, hand the reason on.
tl::unexpected<Error> abandon(SessionFolder& folder, const Provenance& provenance, Error error) {
  (void)close_session(folder, provenance, error);
  return tl::unexpected<Error>(std::move(error));
}

Result<void> write_results(SessionFolder& folder, const Provenance& provenance, const ExperimentOutcome& outcome) {
  if (auto written = folder.write_curves(outcome.curve, outcome.twin, provenance.side); !written) return written;
  if (outcome.comparison) {
    if (auto written = folder.write_comparison(*outcome.comparison); !written) return written;
  }
  return close_session(folder, provenance, outcome.ended_by);
}

/// The last step of every run that has a curve. A disk that refuses ends the session early; the results still reach the
/// caller.
ExperimentOutcome concluded(ExperimentOutcome outcome, const Plan& plan, SessionFolder& folder,
                            const Provenance& provenance) {
  outcome.verdict = judge(plan.limits, outcome.curve, outcome.comparison);
  if (auto written = write_results(folder, provenance, outcome); !written && !outcome.ended_by)
    outcome.ended_by = written.error();
  return outcome;
}

/// Creates the folder and writes what is known before the first frame.
Result<SessionFolder> begin_session(const Plan& plan, const ExperimentOptions& options, const Provenance& provenance) {
  auto folder = SessionFolder::create(options.folder, options.existing);
  if (!folder) return folder;
  if (auto written = folder->write_plan(plan); !written) return tl::unexpected(written.error());
  if (auto written = folder->write_provenance(provenance); !written) return tl::unexpected(written.error());
  return folder;
}

std::chrono::year_month_day today() {
  return std::chrono::floor<std::chrono::days>(std::chrono::system_clock::now());
}

/// What the twin adds to a measured curve; what failed there ends the session early.
struct TwinResults {
  std::optional<RunRecord> run;
  std::optional<TodCurve> curve;
  std::optional<Comparison> comparison;
  std::optional<Error> ended_by;
};

/// The simulated twin at the contrasts that the camera saw, and the comparison.
TwinResults run_twin(const Plan& plan, const Inputs& inputs, const TodCurve& measured, SessionFolder& folder,
                     const ExperimentListener& listener, std::stop_token stop) {
  phase(folder, listener, "simulating its twin " + inputs.sensor.name);
  std::map<double, double> shown;
  for (const auto& point : measured.points) shown[point.set_delta_t_k] = point.delta_t_k;
  auto twin = run_simulated(plan, inputs, folder, SessionCurve::twin, std::move(shown), listener, std::move(stop));
  TwinResults results;
  if (!twin) {
    results.ended_by = with_context("the simulated twin", twin.error());
    return results;
  }
  results.run = run_record(twin->result, twin->wall_s);
  results.ended_by = twin->result.ended_by;
  results.curve = std::move(twin->curve);
  auto comparison = compare(measured, *results.curve, comparison_options(plan));
  if (comparison) {
    results.comparison = std::move(*comparison);
  } else if (!results.ended_by) {
    results.ended_by = with_context("comparing with the simulated twin", comparison.error());
  }
  return results;
}

/// The measurement with the camera of the plan, into the session.
Result<MeasurementResult> run_measured(const Plan& plan, const Inputs& inputs, OpenedBench& bench,
                                       SessionFolder& folder, const ExperimentListener& listener,
                                       std::stop_token stop) {
  TemplateObserver observer(inputs.observer, triangle_alternatives());
  MeasurementOptions options = measurement_options(plan, inputs.plates, plan.camera.ifov_mrad);
  const SensorModel model(inputs.sensor, inputs.effects, inputs.accuracy, plan.seed);
  auto response = responses(model, plan, inputs.plates, options, stop);
  if (!response) return tl::unexpected(response.error());
  options.contrast_response = std::move(*response);
  ListedSchedule schedule(constant_stimuli(stimuli_options(plan, inputs.plates, plan.camera.ifov_mrad, Side::measured),
                                           RandomStream(plan.seed, "schedule")));
  return Recorder(folder, listener, std::move(stop)).run(bench, observer, schedule, options, SessionCurve::main);
}

}  // namespace

Result<ExperimentOutcome> simulate_plan(const Plan& plan, const ExperimentOptions& options,
                                        const ExperimentListener& listener, std::stop_token stop) {
  auto inputs = read_inputs(plan);
  if (!inputs) return tl::unexpected(inputs.error());
  Provenance provenance = begin_provenance(plan, Side::simulated);
  provenance.effects = inputs->effects;
  provenance.target = "simulated scene";
  auto folder = begin_session(plan, options, provenance);
  if (!folder) return tl::unexpected(folder.error());

  phase(*folder, listener, "simulating " + inputs->sensor.name);
  auto run = run_simulated(plan, *inputs, *folder, SessionCurve::main, {}, listener, stop);
  if (!run) return abandon(*folder, provenance, run.error());
  provenance.run = run_record(run->result, run->wall_s);
  return concluded({.folder = folder->path(),
                    .curve = std::move(run->curve),
                    .twin = std::nullopt,
                    .comparison = std::nullopt,
                    .verdict = {},
                    .effects = inputs->effects,
                    .figures = figures_of(*provenance.run),
                    .ended_by = run->result.ended_by},
                   plan, *folder, provenance);
}

Result<ExperimentOutcome> measure_plan(const Plan& plan, const ExperimentOptions& options,
                                       const ExperimentListener& listener, std::stop_token stop) {
  if (plan.camera.id.empty()) return fail(ErrorCode::invalid_input, "the plan names no camera: [camera] id is missing");
  if (auto valid = check_calibration(plan, today()); !valid) return tl::unexpected(valid.error());
  auto inputs = read_inputs(plan);
  if (!inputs) return tl::unexpected(inputs.error());
  if (listener.on_phase) listener.on_phase("opening " + plan.camera.id);
  auto bench = open_bench(plan, inputs->plates, stop);
  if (!bench) return tl::unexpected(bench.error());
  const SourceInfo info = bench->camera->info();
  Provenance provenance = begin_provenance(plan, Side::measured);
  provenance.effects = inputs->effects;
  provenance.camera = camera_record(info);
  provenance.target = bench->target->capabilities().description;
  auto folder = begin_session(plan, options, provenance);
  if (!folder) return tl::unexpected(folder.error());
  for (const auto& warning : info.warnings) note(*folder, listener, warning);

  const auto begin = Clock::now();
  phase(*folder, listener, "measuring " + info.model + " " + info.serial);
  auto result = run_measured(plan, *inputs, *bench, *folder, listener, stop);
  if (!result) return abandon(*folder, provenance, with_context("measuring", result.error()));
  provenance.run = run_record(*result, seconds_since(begin));
  bench->camera.reset();

  auto curve = tod_curve(result->trials, fit_options(plan));
  if (!curve) return abandon(*folder, provenance, curve.error());
  curve->sensor = info.model + " " + info.serial;
  curve->observer = inputs->observer.name;
  ExperimentOutcome outcome{.folder = folder->path(),
                            .curve = std::move(*curve),
                            .twin = std::nullopt,
                            .comparison = std::nullopt,
                            .verdict = {},
                            .effects = inputs->effects,
                            .figures = figures_of(*provenance.run),
                            .ended_by = result->ended_by};
  if (!outcome.ended_by) {
    TwinResults twin = run_twin(plan, *inputs, outcome.curve, *folder, listener, stop);
    provenance.twin_run = std::move(twin.run);
    outcome.twin = std::move(twin.curve);
    outcome.comparison = std::move(twin.comparison);
    outcome.ended_by = std::move(twin.ended_by);
  }
  return concluded(std::move(outcome), plan, *folder, provenance);
}

}  // namespace todbench
