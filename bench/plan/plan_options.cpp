// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/plan_options.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include "tod/schedule/adaptive_schedule.h"

namespace todbench {

std::string_view to_string(Side side) {
  return side == Side::measured ? "measured" : "simulated";
}

MeasurementOptions measurement_options(const Plan& plan, const std::vector<TargetPlate>& plates, double ifov_mrad) {
  MeasurementOptions options;
  options.ifov_mrad = ifov_mrad;
  options.distance_m = plan.target.distance_m;
  options.plates = plates;
  options.registration_frames = plan.measurement.registration_frames;
  options.contrast_frames = plan.measurement.contrast_frames;
  options.min_reference_px = plan.measurement.min_reference_px;
  options.frames_after_change = plan.measurement.frames_after_change;
  options.nuc_interval_s = plan.camera.nuc_interval_s;
  options.nuc_wait_s = plan.camera.nuc_wait_s;
  options.max_rejected_share = plan.measurement.max_rejected_share;
  options.frame_timeout = std::chrono::milliseconds(plan.measurement.frame_timeout_ms);
  options.integrity.max_saturated_share = plan.measurement.max_saturated_share;
  options.registration.pixel_aspect = plan.camera.pixel_aspect;
  options.registration.max_scale_deviation = plan.measurement.max_scale_deviation;
  options.registration.max_rotation_deg = plan.measurement.max_rotation_deg;
  options.registration.max_residual_px = plan.measurement.max_residual_px;
  options.max_readback_deviation_k = plan.measurement.max_readback_deviation_k;
  options.max_shift_error_px = plan.target.max_shift_error_px;
  options.seed = plan.seed;
  return options;
}

MeasurementOptions camera_options(const Plan& plan, const std::vector<TargetPlate>& plates) {
  MeasurementOptions options = measurement_options(plan, plates, plan.camera.ifov_mrad);
  options.contrast_unit = plan.camera.contrast;
  return options;
}

ConstantStimuliOptions stimuli_options(const Plan& plan, const std::vector<TargetPlate>& plates, double ifov_mrad,
                                       Side side) {
  ConstantStimuliOptions options;
  for (const TargetPlate& plate : plates) options.plates.push_back(plate.name);
  options.drawings = plates;
  options.mountings = plan.target.mountings;
  for (std::size_t i = 0; i < plates.size(); ++i) options.mountings_per_plate.push_back(mountings_of(plan.target, i));
  options.delta_t_k = plan.target.delta_t_k;
  options.phases = side == Side::measured ? plan.target.phases : plan.simulation.phases;
  options.pixel_mm = ifov_mrad * plan.target.distance_m;  // mrad times m
  options.pixel_aspect = plan.camera.pixel_aspect;
  const double costs[] = {plan.target.plate_change_s, plan.target.mounting_change_s, plan.target.contrast_change_s,
                          plan.target.shift_change_s};
  std::copy(std::begin(costs), std::end(costs), std::begin(options.change_cost_s));
  return options;
}

RampOptions ramp_options(const Plan& plan, const std::vector<TargetPlate>& plates, double ifov_mrad) {
  const SchedulePlan& schedule = plan.schedule;
  return {.stimuli = stimuli_options(plan, plates, ifov_mrad, Side::measured),
          .from_k = schedule.from_delta_t_k.value_or(0),
          .to_k = schedule.to_delta_t_k.value_or(0),
          .rate_k_per_s = schedule.ramp_k_per_s.value_or(0)};
}

Plan with_settled_contrasts(Plan plan) {
  if (plan.schedule.kind == ScheduleKind::ramp) {
    plan.schedule.kind = ScheduleKind::constant;
    plan.schedule.frames_per_presentation = {frames_of_graded_answers};
  }
  plan.target.contrast_settling_band_percent = 0;
  return plan;
}

Plan with_limits_in_ramp(Plan plan) {
  if (plan.schedule.kind != ScheduleKind::ramp) return plan;
  std::vector<double>& contrasts = plan.target.delta_t_k;
  for (const AcuityLimit& limit : plan.limits.acuity) {
    const auto same = [&](double listed) { return same_contrast(listed, limit.delta_t_k); };
    if (std::ranges::none_of(contrasts, same)) contrasts.push_back(limit.delta_t_k);
  }
  return plan;
}

bool has_own_contrasts(const Plan& plan) {
  return plan.schedule.kind == ScheduleKind::ramp || plan.target.contrast_settling_band_percent > 0;
}

std::unique_ptr<TrialSchedule> make_schedule(const Plan& plan, const std::vector<TargetPlate>& plates, double ifov_mrad,
                                             Side side, const RandomStream& stream,
                                             std::map<double, ProportionTable> functions) {
  const ConstantStimuliOptions stimuli = stimuli_options(plan, plates, ifov_mrad, side);
  if (plan.schedule.kind == ScheduleKind::ramp)
    return std::make_unique<RampSchedule>(ramp_options(plan, plates, ifov_mrad), stream);
  if (plan.schedule.kind == ScheduleKind::constant) {
    std::vector<TargetState> states = constant_stimuli(stimuli, stream);
    if (has_own_contrasts(plan))
      for (TargetState& state : states) state.wait = ContrastWait::within_band;
    return std::make_unique<ListedSchedule>(std::move(states));
  }
  return std::make_unique<AdaptiveSchedule>(AdaptiveOptions{.stimuli = stimuli,
                                                            .plates = plates,
                                                            .distance_m = plan.target.distance_m,
                                                            .fit = fit_options(plan),
                                                            .functions = std::move(functions),
                                                            .half_width_percent = plan.schedule.half_width_percent,
                                                            .with_contrast_errors = side == Side::measured,
                                                            .max_presentations = plan.schedule.max_presentations},
                                            stream);
}

FitOptions fit_options(const Plan& plan) {
  FitOptions options;
  options.form = plan.fit.form;
  options.fixed_lapse = plan.fit.lapse;
  return options;
}

ChosenEstimator chosen_estimator(const Plan& plan, const SensorSpec& sensor) {
  if (plan.fit.estimator == EstimatorChoice::weibull) return {FitEstimator::weibull, EstimatorReason::plan};
  if (plan.fit.estimator == EstimatorChoice::twin_shape) return {FitEstimator::twin_shape, EstimatorReason::plan};
  if (!plan.modules.empty() || !sensor.modules.empty()) return {FitEstimator::weibull, EstimatorReason::modules};
  return {FitEstimator::twin_shape, EstimatorReason::twin};
}

namespace {

/// Returns the presentations of one contrast, the smaller number of camera and twin; for an adaptive schedule an equal
/// share of the maximum.
std::size_t presentations_of_contrast(const Plan& plan) {
  if (plan.schedule.kind == ScheduleKind::adaptive)
    return static_cast<std::size_t>(plan.schedule.max_presentations) /
           std::max<std::size_t>(1, plan.target.delta_t_k.size());
  return set_ups_of(plan.target) * static_cast<std::size_t>(std::min(plan.target.phases, plan.simulation.phases));
}

}  // namespace

int frames_at(const Plan& plan, double delta_t_k) {
  const std::vector<int>& frames = plan.schedule.frames_per_presentation;
  if (frames.size() == 1) return frames[0];
  const std::vector<double>& contrasts = plan.target.delta_t_k;
  for (std::size_t i = 0; i < std::min(frames.size(), contrasts.size()); ++i)
    if (same_contrast(contrasts[i], delta_t_k)) return frames[i];
  return 0;
}

AnswersTaken chosen_answers(const Plan& plan, const SensorSpec& sensor, std::optional<double> delta_t_k) {
  const auto graded = [&](AnswersReason reason) {
    const double first = plan.target.delta_t_k.empty() ? 0 : plan.target.delta_t_k[0];
    const int frames = frames_at(plan, delta_t_k.value_or(first));
    return AnswersTaken{AnswerKind::graded, frames > 0 ? frames : frames_of_graded_answers, reason};
  };
  const auto binary = [](AnswersReason reason) { return AnswersTaken{AnswerKind::binary, 1, reason}; };
  if (plan.schedule.answers == AnswersChoice::graded) return graded(AnswersReason::plan);
  if (plan.schedule.answers == AnswersChoice::binary) return binary(AnswersReason::plan);
  if (chosen_estimator(plan, sensor).estimator == FitEstimator::weibull) return binary(AnswersReason::weibull);
  if (plan.fit.lapse != 0.0) return binary(AnswersReason::lapse);
  if (plan.camera.contrast == ContrastUnit::grey_levels) return binary(AnswersReason::grey_levels);
  // A ramp has many presentations in every set-up, whatever its phases are.
  if (plan.schedule.kind != ScheduleKind::ramp && presentations_of_contrast(plan) < least_graded_presentations)
    return binary(AnswersReason::few_presentations);
  return graded(AnswersReason::twin);
}

ComparisonOptions comparison_options(const Plan& plan) {
  ComparisonOptions options;
  options.margin_percent = plan.limits.equivalence_margin_percent.value_or(options.margin_percent);
  options.fit = fit_options(plan);
  return options;
}

BadPixelRules bad_pixel_rules(const MeasuresPlan& measures) {
  // Response below half of the mean, noise above twice the mean, no rule for the level. Medians stand for the means,
  // because bad pixels change a mean.
  if (measures.pixel_rule == PixelRule::gbt_17444)
    return {.dead_responsivity = 0.5,
            .strong_responsivity = false,
            .noisy = 2,
            .offset = std::numeric_limits<double>::max()};
  return {
      .dead_responsivity = measures.pixels_response, .noisy = measures.pixels_noisy, .offset = measures.pixels_offset};
}

Result<Accuracy> accuracy_of(const Plan& plan) {
  const SimulationPlan& simulation = plan.simulation;
  if (simulation.accuracy == "auto") return Accuracy::for_tolerance(simulation.tolerance_percent);
  Result<Accuracy> accuracy = Accuracy::named(simulation.accuracy);
  if (!accuracy) return accuracy;
  // The direct estimate of a draft cannot meet the tolerance; the others do.
  if (simulation.accuracy != "draft") accuracy->standard_error_percent = simulation.tolerance_percent / 2;
  accuracy->acuity_tolerance_percent = simulation.tolerance_percent;
  return accuracy;
}

}  // namespace todbench
