// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run/measured_run.h"

#include <chrono>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/devices/warm_up_gate.h"
#include "bench/judgement/run_findings.h"
#include "bench/run/grey_results.h"
#include "bench/run/physical_measures.h"
#include "bench/run/trial_recorder.h"
#include "bench/twin/module_chain.h"
#include "bench/twin/simulated_responses.h"
#include "bench/twin/twin_shapes.h"
#include "tod/measurement/contrast_error.h"

namespace todbench {

Result<std::map<std::string, double>> responses_of_camera(const Plan& plan, const ExperimentInputs& inputs,
                                                          std::stop_token stop) {
  const SensorModel model(inputs.sensor, inputs.effects, inputs.accuracy, plan.seed);
  return simulated_responses(model, plan, inputs.plates, camera_options(plan, inputs.plates), std::move(stop));
}

Result<MeasuredRun> run_measured(const Plan& plan, const ExperimentInputs& inputs, CameraSurrogate& surrogate,
                                 OpenedBench& bench, const OpenSession& open, const AddedStages& added,
                                 std::stop_token stop) {
  const SourceInfo at_start = bench.camera->info();
  const auto modules = picture_modules(plan, inputs.sensor, Side::measured);
  const ModuleLine log_line = module_log(open.folder);
  MeasurementOptions options = camera_options(plan, inputs.plates);
  put_behind(bench, modules, added, log_line, options);
  const auto observer = observer_of(plan, inputs, log_line);
  take_answers(options, plan, inputs);
  if (added.as_recorded) added.as_recorded(options);
  options.max_contrast_error = gross_contrast_deviations(plan);
  options.contrast_response = surrogate.responses();
  options.learn_response = [&surrogate](const SetUpPicture& found) { return surrogate.learn(found); };
  TODBENCH_TRY(options.air_transmittance, stated_air(plan, inputs.sensor));
  options.free_running = !bench.simulated;
  options.frames_after_change += settle_frames(modules);
  TODBENCH_TRY(auto functions, stopping_tables(plan, inputs, stop));
  const auto schedule = make_schedule(plan, inputs.plates, plan.camera.ifov_mrad, Side::measured,
                                      RandomStream(plan.seed, "schedule"), functions);
  const AnswerKind kept = added.as_recorded ? AnswerKind::binary : AnswerKind::graded;
  TODBENCH_TRY(auto result, record_trials(open, bench, *observer, *schedule, options, SessionCurve::main, kept, stop));
  options.contrast_response = surrogate.responses();
  options.learn_response = {};
  return MeasuredRun{std::move(result), std::move(options), std::move(functions),
                     changed_settings(*bench.camera, at_start)};
}

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

std::optional<CameraMeasures> measures_of_camera(MeasuredRun& measured, const Plan& plan,
                                                 const ExperimentInputs& inputs, OpenedBench& bench,
                                                 FrameStreamWriter* recording, const OpenSession& open,
                                                 std::stop_token stop) {
  std::optional<Error>& ended_by = measured.result.ended_by;
  if (ended_by) return std::nullopt;
  const auto begin = std::chrono::steady_clock::now();
  auto measures = physical_measures(plan, measured.options, inputs, bench, open, std::move(stop));
  if (!measures) ended_by = measures.error();
  if (plan.measures.any())
    measured.measures_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (recording != nullptr && !ended_by) {
    if (auto kept = recording->verified_frames(); !kept) ended_by = with_context("recording", kept.error());
  }
  return measures ? *std::move(measures) : std::nullopt;
}

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

}  // namespace todbench
