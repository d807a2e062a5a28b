// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run/experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <memory>

#include "acquisition/recording/frame_stream.h"
#include "bench/judgement/run_findings.h"
#include "bench/run/acuity_limits.h"
#include "bench/run/background_twin_functions.h"
#include "bench/run/bench_host.h"
#include "bench/run/camera_settings.h"
#include "bench/run/camera_surrogate.h"
#include "bench/run/comparison_forecast.h"
#include "bench/run/direct_results.h"
#include "bench/run/experiment_inputs.h"
#include "bench/run/grey_results.h"
#include "bench/run/module_chain.h"
#include "bench/run/observed_source.h"
#include "bench/run/own_contrasts.h"
#include "bench/run/paired_comparison.h"
#include "bench/run/physical_measures.h"
#include "bench/run/processed_source.h"
#include "bench/run/recorded_bench.h"
#include "bench/run/session_end.h"
#include "bench/run/simulated_responses.h"
#include "bench/run/simulated_set_up.h"
#include "bench/run/twin_shapes.h"
#include "bench/run/warm_up_gate.h"
#include "bench/text/text.h"
#include "tod/adequacy/adequacy.h"
#include "tod/measurement/contrast_error.h"
#include "tod/measurement/measurement.h"

namespace todbench {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Returns a sentence if the scale of the picture differs by 0.2 % or more from that of distance and IFOV: a distance
/// that is wrong by a share changes the acuity by the same share.
std::string scale_sentence(const SetUpRecord& set_up, double distance_m) {
  constexpr double noted_from = 0.002;
  const double deviation = set_up.registration.scale_deviation;
  if (std::abs(deviation) < noted_from) return "";
  return fmt::format(
      "plate {} is {:.2f} % {} in the picture than at {:g} m with the stated IFOV: check distance_m and ifov_mrad. If "
      "the distance is wrong, the acuity is wrong by the same share",
      set_up.plate, 100 * std::abs(deviation), deviation > 0 ? "larger" : "smaller", distance_m);
}

/// One run of the measurement into its files of trials and presentations.
class Recorder {
 public:
  Recorder(SessionFolder& folder, const ExperimentListener& listener, std::stop_token stop,
           AnswerKind answers = AnswerKind::graded)
      : folder_(folder),
        listener_(listener),
        answers_(answers),
        forward_(std::move(stop), [this] { halt_.request_stop(); }) {}

  /// Writes trials and presentations to the disk one by one. A disk error stops the run with `io`; then the data on the
  /// disk count.
  [[nodiscard]] Result<MeasurementResult> run(OpenedBench& bench, Observer& observer, TrialSchedule& schedule,
                                              const MeasurementOptions& options, SessionCurve which) {
    auto writer = folder_.open_trials(which);
    if (!writer) return tl::unexpected(writer.error());
    auto targets = folder_.open_targets(which);
    if (!targets) return tl::unexpected(targets.error());
    std::optional<Error> write_error;
    std::size_t on_disk = 0;
    const auto keep = [&](const Result<void>& written) {
      if (written || write_error) return;
      write_error = written.error();
      halt_.request_stop();
    };
    MeasurementListener events;
    // A simulated exposure has no host time: its files do not depend on when it is made.
    events.on_trial = [&](Trial trial) {
      if (bench.simulated) trial.host_time_ns = trial.device_time_ns;
      if (answers_ == AnswerKind::binary) trial = binary(std::move(trial));
      if (!write_error) keep(writer->append(trial));
      if (!write_error) ++on_disk;
    };
    events.on_presentation = [&](Presentation shown) {
      if (bench.simulated) shown.host_time_ns.reset();
      if (!write_error) keep(targets->append(shown));
    };
    events.on_patch = [&](const Trial& trial, const Patch& patch) {
      if (listener_.on_trial && !write_error) listener_.on_trial(which, trial, patch);
    };
    std::vector<std::string> scale_notes;
    events.on_set_up = [&](const SetUpRecord& set_up) {
      if (auto sentence = scale_sentence(set_up, options.distance_m);
          !sentence.empty() && which == SessionCurve::main) {
        note(folder_, listener_, sentence);
        scale_notes.push_back(std::move(sentence));
      }
      if (listener_.on_set_up) listener_.on_set_up(which, set_up);
    };
    events.on_progress = listener_.on_progress;
    events.on_note = [&](const std::string& sentence) { note(folder_, listener_, sentence); };
    events.on_rejected = [&](const RejectedFrame& frame) {
      (void)folder_.log("frame " + std::to_string(frame.sequence) +
                        " not used: " + std::string(to_string(frame.reason)) +
                        (frame.seen ? " (" + std::string(to_string(*frame.seen)) + ")" : ""));
    };
    events.on_lost = [&](const Error&) { say_that_camera_is_awaited(bench); };
    auto result =
        measure(*bench.camera, *bench.target, observer, schedule, options, *bench.host, events, halt_.get_token());
    if (result && answers_ == AnswerKind::binary) {
      for (Trial& trial : result->trials) trial = binary(std::move(trial));
    }
    if (result) result->notes.insert(result->notes.end(), scale_notes.begin(), scale_notes.end());
    keep(writer->sync());
    keep(targets->sync());
    if (write_error) {
      if (!result || on_disk == 0) return tl::unexpected(*write_error);
      result->trials.resize(std::min(on_disk, result->trials.size()));
      result->ended_by = write_error;
    }
    return result;
  }

 private:
  /// The answer to the first frame, which is that of a run without graded answers.
  static Trial binary(Trial trial) {
    trial.probability_correct.reset();
    trial.frames = 1;
    return trial;
  }
  void say_that_camera_is_awaited(const OpenedBench& bench) {
    const SourceInfo& info = bench.camera->info();
    const auto patience_s = std::chrono::duration<double>(bench.patience).count();
    if (patience_s > 0) {
      note(folder_, listener_,
           "camera lost, waiting " + number_text(patience_s) + " s for " + info.model + " with serial number " +
               info.serial);
    }
    if (listener_.on_lost) listener_.on_lost(info, bench.patience);
  }

  SessionFolder& folder_;
  const ExperimentListener& listener_;
  AnswerKind answers_;  ///< binary: graded answers are reduced
  std::stop_source halt_;
  std::stop_callback<std::function<void()>> forward_;
};

/// Writes the first lines of the modules' standard error to the log of the session.
ModuleLine module_log(SessionFolder& folder) {
  constexpr int most_lines = 1000;
  return [&folder, lines = std::make_shared<int>(0)](std::string_view line) {
    if (++*lines <= most_lines) (void)folder.log("module: " + one_line(std::string(line)));
  };
}

/// Passes the frames of a bench through the modules, then through the added stages.
void put_behind(OpenedBench& bench, const std::vector<ModulePlan>& modules, const AddedStages& added,
                const ModuleLine& log_line, MeasurementOptions& options) {
  auto stages = module_stages(modules, log_line);
  if (added.make) std::ranges::move(added.make(log_line), std::back_inserter(stages));
  options.judged_samples_per_pixel = samples_per_pixel(stages);
  put_stages_behind(bench, std::move(stages));
}

/// The plan's own trial design on the simulated sensor.
struct TwinRun {
  MeasurementResult result;
  TodCurve curve;
  double wall_s = 0;
};

/// Whether all trials of a plan were made.
enum class Trials { all, ended_early };

Trials trials_of(const MeasurementResult& result) {
  return result.ended_by ? Trials::ended_early : Trials::all;
}

/// Fits a curve with the functions of its simulated sensor, if the plan requests it. `known`: of fit_twin_shapes().
TwinShapesOutcome take_shape(TodCurve& curve, std::span<const Trial> trials, Trials made, const Plan& plan,
                             const ExperimentInputs& inputs, const std::map<double, double>& shown_delta_t_k,
                             const TodCurve* known, std::stop_token stop) {
  const ChosenEstimator chosen = chosen_estimator(plan, inputs.sensor);
  const bool by_twin = chosen.estimator == FitEstimator::twin_shape;
  for (TodPoint& point : curve.points) {
    point.estimator_reason = by_twin && made == Trials::ended_early ? EstimatorReason::ended_early : chosen.reason;
    point.answers = chosen_answers(plan, inputs.sensor, point.set_delta_t_k);
  }
  TwinShapesOutcome outcome;
  if (by_twin && made == Trials::all) {
    outcome = fit_twin_shapes(curve, trials, inputs, fit_options(plan),
                              direct_options(curve, inputs, shown_delta_t_k, plan.seed, std::move(stop)), known);
  }
  fit_right_and_wrong(curve, trials, fit_options(plan));
  compare_orientations(curve, trials);
  return outcome;
}

/// Answers of a run as they are fitted, and the function over contrast if presentations have contrasts of their own.
struct FittedTrials {
  std::vector<Trial> own{};                  ///< at the set contrasts
  std::optional<ContrastSurface> surface{};  ///< empty: contrasts were settled
  std::optional<Error> failed{};

  [[nodiscard]] std::span<const Trial> of(const MeasurementResult& run) const {
    return surface ? std::span<const Trial>(own) : std::span<const Trial>(run.trials);
  }
};

FittedTrials trials_to_fit(const MeasurementResult& run, const Plan& plan, const ExperimentInputs& inputs,
                           const std::stop_token& stop) {
  if (!has_own_contrasts(plan) || run.ended_by || run.trials.empty()) return {};
  auto surface = contrast_surface(plan, inputs, stop);
  if (!surface) return {.failed = surface.error()};
  const double air = run.presentations.empty() ? 1 : run.presentations.front().air_transmittance.value_or(1);
  return {.own = at_set_contrasts(run.trials, *surface, air), .surface = *std::move(surface)};
}

/// Takes the fit over all contrasts of a ramp. Returns its finding.
std::optional<AdequacyFinding> take_ramp_of(TodCurve& curve, TwinShapesOutcome& said, const MeasurementResult& run,
                                            const FittedTrials& fitted, const Plan& plan) {
  if (plan.schedule.kind != ScheduleKind::ramp || !fitted.surface || said.ended_by) return std::nullopt;
  auto taken = take_ramp(curve, run, *fitted.surface, plan);
  if (!taken) {
    said.ended_by = with_context("the ramp", taken.error());
    return std::nullopt;
  }
  said.notes.insert(said.notes.end(), taken->notes.begin(), taken->notes.end());
  return std::move(taken->finding);
}

/// Tests every point, and adds what concerns all of them.
void examine_all(TodCurve& curve, const Plan& plan, const std::optional<AdequacyFinding>& of_all) {
  examine(curve, fit_options(plan));
  if (!of_all) return;
  for (TodPoint& point : curve.points)
    if (point.adequacy) point.adequacy->findings.push_back(*of_all);
}

void say_that_it_is_fitted(const MeasurementResult& result, const Plan& plan, const ExperimentInputs& inputs,
                           const OpenSession& open) {
  if (!result.ended_by && chosen_estimator(plan, inputs.sensor).estimator == FitEstimator::twin_shape)
    phase(open.folder, open.listener, "fitting with the functions of " + inputs.sensor.name);
}

/// Stores the outcome of the fit.
void keep_shape(MeasurementResult& result, const TwinShapesOutcome& outcome, const OpenSession& open) {
  if (!result.ended_by) result.ended_by = outcome.ended_by;
  for (const auto& sentence : outcome.notes) {
    note(open.folder, open.listener, sentence);
    result.notes.push_back(sentence);
  }
}

/// Inputs of a twin from its camera; empty for a simulation alone.
struct FromCamera {
  const TodCurve* curve = nullptr;
  const TodCurve* functions = nullptr;         ///< fitted with the functions of the twin
  std::map<double, double> shown_delta_t_k{};  ///< observed contrast for each set contrast
  std::map<std::string, double> responses{};   ///< of simulated_responses(), if they are those of the twin too
};

Result<TwinRun> run_simulated(const Plan& plan, const ExperimentInputs& inputs, SessionFolder& folder,
                              SessionCurve which, const FromCamera& camera, const ExperimentHost& host,
                              const ExperimentListener& listener, std::stop_token stop) {
  const auto begin = Clock::now();
  const ModuleLine log_line = module_log(folder);
  const std::map<double, double>& shown_delta_t_k = camera.shown_delta_t_k;
  auto set_up = simulated_set_up(plan, inputs, shown_delta_t_k, stop, {.on_error_line = log_line}, camera.responses);
  if (!set_up) return tl::unexpected(set_up.error());
  set_up->bench.host = bench_host({.pause = host.pause});
  const auto modules = picture_modules(plan, inputs.sensor, Side::simulated);
  put_behind(set_up->bench, modules, host.added, log_line, set_up->options);
  if (!modules.empty() || host.added.make) {
    set_up->options.frames_after_change = settle_frames(modules) + host.added.memory_frames;
    set_up->options.integrity.reject_frozen = false;
  }
  const auto observer = observer_of(plan, inputs, log_line);
  auto result =
      Recorder(folder, listener, stop).run(set_up->bench, *observer, *set_up->schedule, set_up->options, which);
  if (!result) return fail("simulating", result.error());
  TwinRun run{.result = std::move(*result), .curve = {}, .wall_s = 0};
  const FittedTrials to_fit = trials_to_fit(run.result, plan, inputs, stop);
  if (to_fit.failed) run.result.ended_by = to_fit.failed;
  auto curve = tod_curve(to_fit.of(run.result), fit_options(plan));
  // Report the reason of the early end rather than that its few trials make no curve.
  if (!curve) return tl::unexpected(run.result.ended_by.value_or(curve.error()));
  run.curve = std::move(*curve);
  add_contrast_errors(run.curve, run.result.contrasts);
  run.curve.sensor = inputs.sensor.name;
  run.curve.observer = observer_name(plan, inputs);
  keep_noise(run.result, run.curve);
  for (auto& point : run.curve.points) {
    if (!run.result.judged_contrasts.empty() || sensor_module(inputs.sensor) != nullptr) continue;
    // Noise of the complete sensor: if the planner skips noise, the counts are not representative.
    point.noise_counts = inputs.stated_noise_counts;
  }

  const TodCurve stopped_by = known_functions(set_up->functions, run.curve);
  say_that_it_is_fitted(run.result, plan, inputs, {folder, listener});
  TwinShapesOutcome shaped =
      take_shape(run.curve, to_fit.of(run.result), trials_of(run.result), plan, inputs, shown_delta_t_k,
                 stopped_by.points.empty() ? camera.functions : &stopped_by, stop);
  const auto of_ramp = take_ramp_of(run.curve, shaped, run.result, to_fit, plan);
  keep_shape(run.result, shaped, {folder, listener});
  if (!run.result.ended_by && (has_modules(plan, inputs.sensor) || host.added.make)) {
    const std::string sentence =
        std::string("no direct estimate: it would not include the ") + (host.added.make ? "package" : "modules");
    note(folder, listener, sentence);
    run.result.notes.push_back(sentence);
  } else if (!run.result.ended_by) {
    phase(folder, listener, "estimating " + inputs.sensor.name + " directly");
    DirectResults direct = direct_results(run.curve, inputs, shown_delta_t_k, plan.seed, std::move(stop));
    run.result.ended_by = std::move(direct.ended_by);
    for (auto& sentence : direct.notes) {
      note(folder, listener, sentence);
      run.result.notes.push_back(std::move(sentence));
    }
    for (auto& point : run.curve.points) {
      const auto found = direct.points.find(point.delta_t_k);
      if (found == direct.points.end()) continue;
      point.direct_s75_mrad = found->second.s75_pitch * inputs.sensor.ifov_mrad();
      point.direct_s75_se_mrad = found->second.standard_error_pitch * inputs.sensor.ifov_mrad();
      const auto spread = direct.spread_pitch.find(point.delta_t_k);
      if (spread == direct.spread_pitch.end()) continue;
      point.s75_spread_mrad = {spread->second.first * inputs.sensor.ifov_mrad(),
                               spread->second.second * inputs.sensor.ifov_mrad()};
    }
  }
  examine_all(run.curve, plan, of_ramp);
  run.wall_s = seconds_since(begin);
  return run;
}

std::chrono::year_month_day today() {
  return std::chrono::floor<std::chrono::days>(std::chrono::system_clock::now());
}

/// Results that the twin adds to a measured curve; its errors end the session early.
struct TwinResults {
  std::optional<RunRecord> run;
  std::optional<TodCurve> curve;
  std::optional<Comparison> comparison;
  std::optional<Error> ended_by;
};

/// Simulates the twin at the contrasts that the camera observed, and compares.
TwinResults run_twin(const Plan& plan, const ExperimentInputs& inputs, const FromCamera& camera, SessionFolder& folder,
                     const ExperimentHost& host, const ExperimentListener& listener, std::stop_token stop) {
  phase(folder, listener, "simulating its twin " + inputs.sensor.name);
  auto twin = run_simulated(plan, inputs, folder, SessionCurve::twin, camera, host, listener, std::move(stop));
  TwinResults results;
  if (!twin) {
    results.ended_by = with_context("the simulated twin", twin.error());
    return results;
  }
  results.run = run_record(twin->result, twin->wall_s);
  results.ended_by = twin->result.ended_by;
  results.curve = std::move(twin->curve);
  ComparisonOptions options = comparison_options(plan);
  options.b_shown_contrasts_of_a = true;
  auto comparison = compare(*camera.curve, *results.curve, options);
  if (comparison) {
    results.comparison = std::move(*comparison);
  } else if (!results.ended_by) {
    results.ended_by = with_context("comparing with the simulated twin", comparison.error());
  }
  return results;
}

/// The same by the phases that camera and twin both observed.
void pair_with_twin(ExperimentOutcome& outcome, BackgroundTask<Pairs>& made, const ExperimentInputs& inputs,
                    const OpenSession& open, std::stop_token stop) {
  if (!outcome.comparison || outcome.ended_by) return;
  phase(open.folder, open.listener, "presenting the camera's targets to " + inputs.sensor.name);
  const Pairs& pairs = made.get(std::move(stop));
  Comparison& comparison = *outcome.comparison;
  for (std::size_t i = 0; i < comparison.points.size(); ++i) {
    const auto same = std::ranges::find_if(pairs.ratios.points, [&](const ComparisonPoint& point) {
      return point.paired && same_contrast(point.set_delta_t_k, comparison.points[i].set_delta_t_k);
    });
    if (same != pairs.ratios.points.end()) add_paired(comparison, i, *same->paired);
  }
  for (const auto& sentence : pairs.said.notes) note(open.folder, open.listener, sentence);
  outcome.ended_by = pairs.said.ended_by;
}

/// Rejects a tolerance beyond the hard caps before anything is simulated or moved.
Result<void> check_tolerance(const Plan& plan, const ExperimentInputs& inputs) {
  if (has_modules(plan, inputs.sensor)) return {};
  if (const auto prediction = predict_plan(plan, inputs); !prediction) return tl::unexpected(prediction.error());
  return {};
}

/// Trials of the camera.
struct MeasuredRun {
  MeasurementResult result;
  MeasurementOptions options;
  std::map<double, ProportionTable> functions{};  ///< of an adaptive schedule's stopping rule
  std::vector<ChangedSetting> changed{};          ///< of the camera, from its opening to the last frame
};

/// Response of the contrast estimator for the plates, for the camera.
Result<std::map<std::string, double>> responses_of_camera(const Plan& plan, const ExperimentInputs& inputs,
                                                          std::stop_token stop) {
  const SensorModel model(inputs.sensor, inputs.effects, inputs.accuracy, plan.seed);
  return simulated_responses(model, plan, inputs.plates, camera_options(plan, inputs.plates), std::move(stop));
}

/// Measures with the camera of the plan, into the session.
Result<MeasuredRun> run_measured(const Plan& plan, const ExperimentInputs& inputs, CameraSurrogate& surrogate,
                                 OpenedBench& bench, SessionFolder& folder, const AddedStages& added,
                                 const ExperimentListener& listener, std::stop_token stop) {
  const SourceInfo at_start = bench.camera->info();
  const auto modules = picture_modules(plan, inputs.sensor, Side::measured);
  const ModuleLine log_line = module_log(folder);
  MeasurementOptions options = camera_options(plan, inputs.plates);
  put_behind(bench, modules, added, log_line, options);
  const auto observer = observer_of(plan, inputs, log_line);
  take_answers(options, plan, inputs);
  if (added.as_recorded) added.as_recorded(options);
  options.max_contrast_error = gross_contrast_deviations(plan);
  options.contrast_response = surrogate.responses();
  options.learn_response = [&surrogate](const SetUpPicture& found) { return surrogate.learn(found); };
  const auto air = stated_air(plan, inputs.sensor);
  if (!air) return tl::unexpected(air.error());
  options.air_transmittance = *air;
  options.free_running = !bench.simulated;
  options.frames_after_change += settle_frames(modules);
  auto functions = stopping_tables(plan, inputs, stop);
  if (!functions) return tl::unexpected(functions.error());
  const auto schedule = make_schedule(plan, inputs.plates, plan.camera.ifov_mrad, Side::measured,
                                      RandomStream(plan.seed, "schedule"), *functions);
  const AnswerKind kept = added.as_recorded ? AnswerKind::binary : AnswerKind::graded;
  auto result = Recorder(folder, listener, stop, kept).run(bench, *observer, *schedule, options, SessionCurve::main);
  if (!result) return tl::unexpected(result.error());
  options.contrast_response = surrogate.responses();
  options.learn_response = {};
  return MeasuredRun{*std::move(result), std::move(options), *std::move(functions),
                     changed_settings(*bench.camera, at_start)};
}

std::map<double, double> contrasts_seen(const TodCurve& curve) {
  std::map<double, double> seen;
  for (const auto& point : curve.points) seen[point.set_delta_t_k] = point.delta_t_k;
  return seen;
}

/// Returns the curve of these trials without the shape of the twin. Fails if they make none.
Result<TodCurve> curve_of_camera(MeasurementResult& result, std::span<const Trial> trials, const Plan& plan,
                                 const ExperimentInputs& inputs, const SourceInfo& info, const OpenSession& open) {
  auto curve = tod_curve(trials, fit_options(plan));
  if (!curve) return tl::unexpected(result.ended_by.value_or(curve.error()));
  add_contrast_errors(*curve, result.contrasts);
  curve->sensor = info.model + " " + info.serial;
  curve->observer = observer_name(plan, inputs);
  keep_noise(result, *curve);
  if (auto kept = keep_grey_levels(*curve, result, open); !kept && !result.ended_by) result.ended_by = kept.error();
  return curve;
}

/// A curve with the shape of the twin.
struct FittedCurve {
  TodCurve curve;
  TwinShapesOutcome said;
  std::optional<TodCurve> by_twin{};  ///< with the function of the twin, if `curve` has that of the surrogate

  std::map<double, double> model_u{};  ///< by set contrast, if the pictures contradict the model

  [[nodiscard]] const TodCurve& functions_of_twin() const { return by_twin ? *by_twin : curve; }
};

std::vector<AdequacyFinding> findings_of(const std::vector<ChangedSetting>& changed) {
  std::vector<AdequacyFinding> out;
  for (const ChangedSetting& one : changed)
    out.push_back({FindingKind::setting_change, {}, {}, sentence(one), scales_counts(one.feature)});
  return out;
}

/// Widens the interval if the pictures contradict the model or could not be compared. The half-width of a rectangular
/// distribution is the largest of: the difference between the functions or responses of twin and surrogate, and the
/// effect of another slope.
void widen_where_not_verified(FittedCurve& fitted, const CameraSurrogate& surrogate) {
  if (!surrogate.refused() && !surrogate.unseen()) return;
  for (TodPoint& point : fitted.curve.points) {
    if (!surrogate.refused() && !point.fit.twin_shape) continue;
    double shift = surrogate.response_shift();
    if (point.fit.twin_shape) shift = std::max(shift, std::abs(point.fit.twin_shape->departure_shift));
    const TodPoint* twin = fitted.by_twin ? point_at(*fitted.by_twin, point.set_delta_t_k) : nullptr;
    if (twin != nullptr && twin->fit.threshold && point.fit.threshold)
      shift = std::max(shift, std::abs(std::log(*point.fit.threshold / *twin->fit.threshold)));
    fitted.model_u[point.set_delta_t_k] = shift / std::sqrt(3.0);
    join_uncertainty(point.fit, fitted.model_u[point.set_delta_t_k], std::nullopt);
  }
}

/// Fits on its own thread: an effective contrast that differs by more than 2 % from the set one needs its own function,
/// which takes a second. Borrowed objects outlive it. `functions`: null if an adaptive schedule stopped by those of
/// `measured`.
std::unique_ptr<BackgroundTask<FittedCurve>> fit_in_background(TodCurve curve, const MeasuredRun& measured,
                                                               const FittedTrials& to_fit, const Plan& plan,
                                                               const ExperimentInputs& inputs,
                                                               BackgroundTwinFunctions* functions,
                                                               const CameraSurrogate& surrogate) {
  const Trials made = trials_of(measured.result);
  const std::span<const Trial> trials = to_fit.of(measured.result);
  return std::make_unique<BackgroundTask<FittedCurve>>([curve = std::move(curve), made, trials, &measured, &to_fit,
                                                        &plan, &inputs, functions, &surrogate](std::stop_token stop) {
    TodCurve known;
    if (made == Trials::all)
      known = functions != nullptr ? functions->known_for(curve, stop) : known_functions(measured.functions, curve);
    FittedCurve fitted{curve, {}};
    fitted.said = take_shape(fitted.curve, trials, made, plan, inputs, contrasts_seen(curve), &known, stop);
    const auto lent = surrogate.lent();
    if (lent && made == Trials::all && !fitted.said.ended_by &&
        chosen_estimator(plan, inputs.sensor).estimator == FitEstimator::twin_shape) {
      fitted.by_twin = std::move(fitted.curve);
      fitted.curve = curve;
      fitted.said = take_shape(fitted.curve, trials, made, plan, *lent, contrasts_seen(curve), nullptr, stop);
    }
    const auto of_ramp = take_ramp_of(fitted.curve, fitted.said, measured.result, to_fit, plan);
    join_contrast_errors(fitted.curve);
    widen_where_not_verified(fitted, surrogate);
    examine_all(fitted.curve, plan, of_ramp);
    for (TodPoint& point : fitted.curve.points)
      if (point.adequacy && fitted.model_u.contains(point.set_delta_t_k))
        point.adequacy->findings.push_back(surrogate.finding());
    const MeasurementResult& run = measured.result;
    const auto settings = findings_of(measured.changed);
    for (auto& sentence :
         add_run_findings(fitted.curve, plan, {run.presentations, run.contrasts, run.constancy, settings}))
      fitted.said.notes.push_back(std::move(sentence));
    return fitted;
  });
}

/// Takes the camera's physical measures, then checks that the recording is complete on disk.
std::optional<CameraMeasures> measures_of_camera(MeasuredRun& measured, const Plan& plan,
                                                 const ExperimentInputs& inputs, OpenedBench& bench,
                                                 FrameStreamWriter* recording, const OpenSession& open,
                                                 std::stop_token stop) {
  std::optional<Error>& ended_by = measured.result.ended_by;
  if (ended_by) return std::nullopt;
  auto measures = physical_measures(plan, measured.options, inputs, bench, open, std::move(stop));
  if (!measures) ended_by = measures.error();
  if (recording != nullptr && !ended_by) {
    if (auto kept = recording->verified_frames(); !kept) ended_by = with_context("recording", kept.error());
  }
  return measures ? *std::move(measures) : std::nullopt;
}

/// The warm-up of [camera.warm_up]. A camera that warms up corrects itself often.
Result<std::string> warmed_up(FrameSource& camera, const Plan& plan, const std::stop_token& stop) {
  constexpr double most_rejected_share = 0.5;
  FrameTakerOptions taking;
  taking.frames_after_change = 0;
  taking.nuc_wait_s = plan.camera.nuc_wait_s;
  taking.max_rejected_share = most_rejected_share;
  taking.frame_timeout = std::chrono::milliseconds(plan.measurement.frame_timeout_ms);
  taking.integrity.width = camera.info().width;
  taking.integrity.height = camera.info().height;
  return wait_for_warm_up(camera, plan.camera.warm_up, taking, stop);
}

/// Work started in parallel to the camera.
struct BackgroundWork {
  BackgroundTask<Pairs>* pairs;  ///< null: none are made
  BackgroundMeasures& measures;
};

/// The measured thresholds with the relative spread of the twin's: both have the same observer.
void take_spread(TodCurve& curve, const TodCurve& twin) {
  for (TodPoint& point : curve.points) {
    const auto same = std::ranges::find_if(
        twin.points, [&](const TodPoint& other) { return same_contrast(other.set_delta_t_k, point.set_delta_t_k); });
    if (same == twin.points.end() || !same->s75_spread_mrad || !same->direct_s75_mrad || !point.fit.threshold) continue;
    const double scale = *point.fit.threshold / *same->direct_s75_mrad;
    point.s75_spread_mrad = {same->s75_spread_mrad->first * scale, same->s75_spread_mrad->second * scale};
  }
}

/// Adds run, comparison and physical measures of the twin.
void add_twin(ExperimentOutcome& outcome, Provenance& provenance, const FromCamera& camera, const LoadedPlan& loaded,
              const Plan& plan, const ExperimentInputs& inputs, const BackgroundWork& background,
              const ExperimentHost& host, const OpenSession& open, const std::stop_token& stop) {
  TwinResults twin = run_twin(plan, inputs, camera, open.folder, host, open.listener, stop);
  provenance.twin_run = std::move(twin.run);
  outcome.twin = std::move(twin.curve);
  if (outcome.twin) take_spread(outcome.curve, *outcome.twin);
  outcome.comparison = std::move(twin.comparison);
  outcome.ended_by = std::move(twin.ended_by);
  if (background.pairs != nullptr) pair_with_twin(outcome, *background.pairs, inputs, open, stop);
  if (outcome.ended_by) return;
  if (outcome.measures) compare_picture(*outcome.measures, loaded, inputs);
  auto measures = background.measures.take(open, stop);
  if (measures)
    outcome.twin_measures = *std::move(measures);
  else
    outcome.ended_by = with_context("the simulated twin", measures.error());
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

}  // namespace

Result<ExperimentOutcome> simulate_plan(const Plan& plan, const ExperimentOptions& options,
                                        const ExperimentListener& listener, std::stop_token stop) {
  const auto loaded = LoadedPlan::load(plan);
  if (!loaded) return tl::unexpected(loaded.error());
  return simulate_plan(*loaded, options, listener, std::move(stop));
}

Result<ExperimentOutcome> simulate_plan(const LoadedPlan& loaded, const ExperimentOptions& options,
                                        const ExperimentListener& listener, std::stop_token stop) {
  EffectPlanner planner;
  auto inputs = experiment_inputs(loaded, planner);
  if (!inputs) return tl::unexpected(inputs.error());
  const auto chosen = loaded.with(with_frames(with_limits_in_ramp(loaded.plan()), *inputs));
  if (!chosen) return tl::unexpected(chosen.error());
  const Plan& plan = chosen->plan();
  Provenance provenance = begin_provenance(plan, Side::simulated);
  provenance.effects = inputs->effects;
  provenance.modules = module_records(plan, inputs->sensor, Side::simulated);
  provenance.target = "simulated scene";
  if (auto fits = check_simulated_geometry(plan, *inputs); !fits) return tl::unexpected(fits.error());
  if (auto possible = check_tolerance(plan, *inputs); !possible) return tl::unexpected(possible.error());
  auto folder = begin_session(*chosen, options, provenance);
  if (!folder) return tl::unexpected(folder.error());
  const OpenSession open{*folder, listener};
  if (listener.on_session) listener.on_session(folder->path());
  note_failed_selftest(open, provenance);

  for (const auto& warning : inputs->warnings) note(*folder, listener, warning);
  phase(*folder, listener, "simulating " + inputs->sensor.name);
  auto run = run_simulated(plan, *inputs, *folder, SessionCurve::main, {}, options.host, listener, stop);
  if (!run) {
    // At contrasts below the threshold the plate may not be found either: report the cause, not the symptom.
    if (!inputs->identifiable && run.error().code == ErrorCode::calibration)
      return abandon(open, plan, provenance,
                     {ErrorCode::not_identifiable, inputs->warnings.front() + "; " + run.error().message});
    return abandon(open, plan, provenance, run.error());
  }
  std::optional<CameraMeasures> measures;
  if (!run->result.ended_by) {
    auto found = simulated_measures(loaded, *inputs, open, stop);
    if (found)
      measures = *std::move(found);
    else
      run->result.ended_by = found.error();
  }
  run->result.notes.insert(run->result.notes.end(), inputs->warnings.begin(), inputs->warnings.end());
  provenance.run = run_record(run->result, run->wall_s);
  ExperimentOutcome outcome{.folder = folder->path(),
                            .curve = std::move(run->curve),
                            .twin = std::nullopt,
                            .comparison = std::nullopt,
                            .verdict = {},
                            .measures = std::move(measures),
                            .effects = inputs->effects,
                            .figures = figures_of(*provenance.run),
                            .ended_by = run->result.ended_by,
                            .presentations = std::move(run->result.presentations)};
  add_display(outcome, provenance, plan, *inputs, open, stop);
  return concluded(std::move(outcome), plan, open, provenance);
}

Result<ExperimentOutcome> measure_plan(const Plan& plan, const ExperimentOptions& options,
                                       const ExperimentListener& listener, std::stop_token stop) {
  const auto loaded = LoadedPlan::load(plan);
  if (!loaded) return tl::unexpected(loaded.error());
  return measure_plan(*loaded, options, listener, std::move(stop));
}

Result<ExperimentOutcome> measure_plan(const LoadedPlan& loaded, const ExperimentOptions& options,
                                       const ExperimentListener& listener, std::stop_token stop) {
  const Plan& plan = loaded.plan();
  if (plan.camera.id.empty()) return fail(ErrorCode::invalid_input, "the plan names no camera: [camera] id is missing");
  if (auto valid = check_calibration(plan, today()); !valid) return tl::unexpected(valid.error());
  EffectPlanner planner;
  auto inputs = experiment_inputs(loaded, planner);
  if (!inputs) return tl::unexpected(inputs.error());
  if (auto possible = check_tolerance(plan, *inputs); !possible) return tl::unexpected(possible.error());
  if (listener.on_phase) listener.on_phase("opening " + plan.camera.id);
  auto bench = open_bench(loaded, stop, options.host, listener.on_phase, listener.on_wait);
  if (!bench) return tl::unexpected(bench.error());
  return measure_on_bench(loaded, *inputs, *std::move(bench), options, listener, std::move(stop));
}

Result<ExperimentOutcome> measure_on_bench(const LoadedPlan& loaded, const ExperimentInputs& inputs, OpenedBench bench,
                                           const ExperimentOptions& options, const ExperimentListener& listener,
                                           std::stop_token stop) {
  const auto chosen = loaded.with(with_frames(with_limits_in_ramp(loaded.plan()), inputs));
  if (!chosen) return tl::unexpected(chosen.error());
  const Plan& plan = chosen->plan();
  if (listener.on_open) listener.on_open(bench.camera->info());
  if (listener.on_frame) bench.camera = observed_source(std::move(bench.camera), listener.on_frame);
  const SourceInfo info = bench.camera->info();
  if (auto possible = check_contrast_of(plan, inputs, info); !possible) return tl::unexpected(possible.error());
  if (auto fits = check_measured_geometry(plan, inputs, {info.width, info.height}); !fits)
    return tl::unexpected(fits.error());
  if (auto fits = check_simulated_geometry(plan, inputs); !fits) return fail("the simulated twin", fits.error());
  Provenance provenance = begin_provenance(plan, Side::measured);
  provenance.effects = inputs.effects;
  provenance.modules = module_records(plan, inputs.sensor, Side::simulated);
  provenance.camera = camera_record(info);
  provenance.target = bench.target->capabilities().description;
  provenance.origin = options.origin;
  auto folder = begin_session(*chosen, options, provenance);
  if (!folder) return tl::unexpected(folder.error());
  const OpenSession open{*folder, listener};
  if (listener.on_session) listener.on_session(folder->path());
  note_failed_selftest(open, provenance);
  for (const auto& warning : info.warnings) note(*folder, listener, warning);
  for (const auto& warning : bench.warnings) note(*folder, listener, warning);
  for (const auto& warning : inputs.warnings) note(*folder, listener, warning);
  std::string warm_up;
  if (plan.camera.warm_up.stated() && !options.host.added.as_recorded) {
    phase(*folder, listener, "waiting until " + info.model + " is warm");
    auto warm = warmed_up(*bench.camera, plan, stop);
    if (!warm) return abandon(open, plan, provenance, with_context("warm-up", warm.error()));
    warm_up = *std::move(warm);
    note(*folder, listener, warm_up);
  }
  std::shared_ptr<FrameStreamWriter> recording;
  if (plan.measurement.record_frames) {
    auto begun = record_bench(bench, folder->path());
    if (!begun) return abandon(open, plan, provenance, begun.error());
    recording = *std::move(begun);
  }

  std::string forecast;
  // The prediction does not include a package.
  if (const auto prediction = predict_plan(plan, inputs); prediction && !options.host.added.make)
    forecast = comparison_forecast(plan, *prediction).sentence;
  if (!forecast.empty()) note(*folder, listener, forecast);

  const auto begin = Clock::now();
  phase(*folder, listener, "measuring " + info.model + " " + info.serial);
  auto responses = responses_of_camera(plan, inputs, stop);
  if (!responses) return abandon(open, plan, provenance, with_context("measuring", responses.error()));
  std::optional<BackgroundTwinFunctions> functions;
  if (plan.schedule.kind != ScheduleKind::adaptive) functions.emplace(plan, inputs);
  BackgroundMeasures twin_measures(loaded, inputs);
  CameraSurrogate surrogate(*chosen, inputs, *responses);
  auto measured = run_measured(plan, inputs, surrogate, bench, *folder, options.host.added, listener, stop);
  if (!measured) return abandon(open, plan, provenance, with_context("measuring", measured.error()));
  MeasurementResult& result = measured->result;
  result.notes.insert(result.notes.end(), inputs.warnings.begin(), inputs.warnings.end());
  if (!forecast.empty()) result.notes.push_back(forecast);
  if (!warm_up.empty()) result.notes.push_back(warm_up);
  provenance.camera_optics = surrogate.record();
  if (const auto sentence = surrogate.sentence()) {
    note(*folder, listener, *sentence);
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
  std::unique_ptr<BackgroundTask<Pairs>> pairs;
  if (!result.ended_by) {
    const auto camera_of = [&](std::stop_token halt) {
      const FittedCurve& made = fit->get(std::move(halt));
      return PairedCamera{made.curve,    result.trials,    result.set_ups, made.by_twin ? &*made.by_twin : nullptr,
                          &made.model_u, to_fit.of(result)};
    };
    pairs = pairs_in_background(camera_of, plan, inputs);
  }
  auto measures = measures_of_camera(*measured, plan, inputs, bench, recording.get(), open, stop);
  bench = {};
  say_that_it_is_fitted(result, plan, inputs, open);
  const FittedCurve& fitted = fit->get(stop);
  keep_shape(result, fitted.said, open);
  provenance.run = run_record(result, seconds_since(begin));
  ExperimentOutcome outcome{.folder = folder->path(),
                            .curve = fitted.curve,
                            .twin = std::nullopt,
                            .comparison = std::nullopt,
                            .verdict = {},
                            .measures = std::move(measures),
                            .effects = inputs.effects,
                            .figures = figures_of(*provenance.run),
                            .ended_by = result.ended_by,
                            .presentations = std::move(result.presentations)};
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
