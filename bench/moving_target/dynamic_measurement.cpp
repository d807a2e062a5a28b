// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/moving_target/dynamic_measurement.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "acquisition/base/distributions.h"
#include "acquisition/base/try.h"
#include "bench/judgement/run_findings.h"
#include "bench/plan/descriptions.h"
#include "bench/plan/plan_options.h"
#include "bench/twin/module_chain.h"
#include "bench/twin/simulated_responses.h"
#include "sim_devices/scene/scene_motion.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

bool asked_at(double speed_mrad_s, const MovingAnswer& answer, SequenceObserver observer, double set_delta_t_k) {
  return answer.speed_mrad_s == speed_mrad_s && answer.observer == observer &&
         answer.trial.set_delta_t_k == set_delta_t_k;
}

/// Counts correct answers by pass and size; clusters are passes.
std::vector<Level> levels_by_pass(const std::vector<Trial>& trials) {
  std::map<std::pair<std::int64_t, double>, Level> by_pass;
  for (const Trial& trial : trials) {
    Level& level = by_pass[{trial.presentation, trial.size_mrad}];
    level.size = trial.size_mrad;
    level.correct += trial.correct() ? 1 : 0;
    level.total += 1;
    level.cluster = static_cast<int>(trial.presentation);
  }
  std::vector<Level> levels;
  for (const auto& [key, level] : by_pass) levels.push_back(level);
  return levels;
}

/// Acuities at one contrast, by speed.
Result<std::vector<DynamicAcuity>> speeds_of(const std::vector<MovingAnswer>& answers, double frame_rate_hz,
                                             const std::vector<double>& speeds, double set_delta_t_k,
                                             const SensorSpec& sensor, const FitOptions& fit) {
  std::vector<DynamicAcuity> out;
  std::map<SequenceObserver, std::vector<Trial>> at_rest;
  for (const double speed : speeds) {
    DynamicAcuity at = dynamic_acuity_at(sensor, speed, speed / sensor.ifov_mrad() / frame_rate_hz);
    for (const SequenceObserver kind : all_sequence_observers) {
      std::vector<Trial> trials;
      for (const MovingAnswer& answer : answers) {
        if (asked_at(speed, answer, kind, set_delta_t_k)) trials.push_back(answer.trial);
      }
      if (speed == 0) at_rest[kind] = trials;
      if (trials.empty()) return fail(ErrorCode::integrity, "no pass could be measured at one of the speeds");
      TODBENCH_TRY(auto point, dynamic_point(kind, levels_by_pass(trials), trials, at_rest[kind], fit));
      at.points.push_back(std::move(point));
    }
    out.push_back(std::move(at));
  }
  return out;
}

Result<DynamicContrast> contrast_of(const MovingMeasurement& measured, const std::vector<double>& speeds,
                                    double set_delta_t_k, const SensorSpec& sensor, const FitOptions& fit) {
  DynamicContrast out{.set_delta_t_k = set_delta_t_k, .delta_t_k = 0, .speeds = {}};
  double passes = 0;
  for (const MovingPassRecord& pass : measured.passes) {
    if (pass.set_delta_t_k != set_delta_t_k) continue;
    out.delta_t_k += pass.delta_t_k;
    passes += 1;
  }
  out.delta_t_k /= std::max(1.0, passes);
  const auto of = [&](const std::vector<MovingAnswer>& answers) {
    return speeds_of(answers, measured.frame_rate_hz, speeds, set_delta_t_k, sensor, fit);
  };
  TODBENCH_TRY(out.speeds, of(measured.answers));
  if (measured.answers_at_ends.front().empty()) return out;
  auto best = of(measured.answers_at_ends[0]), worst = of(measured.answers_at_ends[1]);
  if (!best) return tl::unexpected(best.error());
  if (!worst) return tl::unexpected(worst.error());
  add_spreads({*std::move(best), *std::move(worst)}, out.speeds);
  return out;
}

struct MovingBench {
  OpenedBench bench;
  double ifov_mrad = 0;
};

Result<MovingBench> opened(const LoadedPlan& loaded, const std::shared_ptr<const SensorModel>& model,
                           std::stop_token stop) {
  const Plan& plan = loaded.plan();
  if (!plan.camera.id.empty()) {
    TODBENCH_TRY(auto bench, open_bench(loaded, std::move(stop)));
    return MovingBench{std::move(bench), plan.camera.ifov_mrad};
  }
  return MovingBench{simulated_bench(model, loaded.plates(), plan.target.distance_m, {}), model->spec().ifov_mrad()};
}

}  // namespace

std::optional<MeasuredTimeConstant> time_constant_of(const std::vector<MovingPassRecord>& passes, double exposure_ms) {
  // Normal equations of y = L v + e d, unknown L (lag) and e (offset).
  double vv = 0, vd = 0, dd = 0, vy = 0, dy = 0, yy = 0;
  int n = 0, right = 0;
  for (const MovingPassRecord& pass : passes) {
    if (!pass.lag_s || !pass.dropped.empty()) continue;
    const double v = pass.said_px_s, d = pass.along_x, y = v * *pass.lag_s;
    vv += v * v, vd += v * d, dd += d * d, vy += v * y, dy += d * y, yy += y * y;
    ++n;
    right += d > 0 ? 1 : 0;
  }
  if (n < 4 || right == 0 || right == n) return std::nullopt;
  const double determinant = vv * dd - vd * vd;
  if (!(determinant > 1e-12 * vv * dd)) return std::nullopt;
  const double lag_s = (dd * vy - vd * dy) / determinant, offset_px = (vv * dy - vd * vy) / determinant;
  const double left_over = std::max(0.0, yy - lag_s * vy - offset_px * dy);
  const double error_s = std::sqrt(left_over / (n - 2) * dd / determinant);
  const double t = distribution::quantile(distribution::StudentsT(n - 2), 0.975);
  MeasuredTimeConstant out{.time_constant_ms = 1e3 * lag_s - exposure_ms / 2,
                           .ci95_ms = {},
                           .exposure_ms = exposure_ms,
                           .offset_px = offset_px,
                           .passes = n};
  out.ci95_ms.low = out.time_constant_ms - 1e3 * t * error_s;
  out.ci95_ms.high = out.time_constant_ms + 1e3 * t * error_s;
  return out;
}

Result<DynamicMeasurement> measure_dynamic(const LoadedPlan& loaded, const DynamicListener& listener,
                                           std::stop_token stop) {
  const Plan& plan = loaded.plan();
  if (has_modules(plan, loaded.sensor()))
    return fail(ErrorCode::invalid_input, "a moving target cannot be measured with a [[module]]");
  if (plan.camera.contrast == ContrastUnit::grey_levels)
    return fail(ErrorCode::invalid_input, "a moving target must be measured in kelvin, not in grey levels");
  if (plan.fit.estimator == EstimatorChoice::twin_shape)
    return fail(ErrorCode::invalid_input,
                "the psychometric function of the twin is valid only at rest: [fit] estimator must be 'weibull' or "
                "'automatic'");
  TODBENCH_TRY(const auto accuracy, accuracy_of(plan));
  const auto model = std::make_shared<const SensorModel>(
      loaded.sensor(), full_plan(loaded.sensor(), plan.simulation.skip, plan.simulation.force, any_motion), accuracy,
      plan.seed);
  TODBENCH_TRY(auto moving, opened(loaded, model, stop));
  OpenedBench& bench = moving.bench;
  MovingMeasurementOptions options{.measurement = measurement_options(plan, loaded.plates(), moving.ifov_mrad),
                                   .mountings = plan.target.mountings,
                                   .delta_t_k = plan.target.delta_t_k,
                                   .speeds_mrad_s = plan.motion.speeds_mrad_s,
                                   .passes = plan.motion.passes,
                                   .frames = plan.motion.frames,
                                   .lead_frames = plan.motion.lead_frames,
                                   .places = plan.motion.places};
  for (std::size_t i = 0; i < loaded.plates().size(); ++i)
    options.mountings_per_plate.push_back(mountings_of(plan.target, i));
  std::erase(options.speeds_mrad_s, 0.0);
  options.speeds_mrad_s.insert(options.speeds_mrad_s.begin(), 0);
  if (plan.camera.id.empty()) {
    options.measurement.samples_per_pitch = loaded.sensor().samples_per_pitch();
    options.measurement.max_shift_error_px = 0;  // the simulated scene shows the plate at the requested place
  } else {
    options.measurement.max_contrast_error = gross_contrast_deviations(plan);
  }
  if (bench.simulated) options.measurement.frames_after_change = 0;
  TODBENCH_TRY(options.measurement.contrast_response,
               simulated_responses(*model, plan, loaded.plates(), options.measurement, stop));
  TemplateObserver observer(loaded.observer(), triangle_alternatives());
  DynamicMeasurement out;
  out.camera = bench.camera->info().id;
  TODBENCH_TRY_VOID(check_moving(bench.camera->info(), *bench.target, observer, options));
  if (listener.on_open) {
    TODBENCH_TRY_VOID(listener.on_open(bench));
  }
  auto measured =
      measure_moving(*bench.camera, *bench.target, observer, options, *bench.host, listener.moving, std::move(stop));
  if (!measured) return tl::unexpected(measured.error());
  if (listener.on_measured) {
    TODBENCH_TRY_VOID(listener.on_measured(*measured));
  }
  if (measured->ended_by) return tl::unexpected(*measured->ended_by);
  out.measured = *std::move(measured);
  const FitOptions fit = fit_options(plan);
  for (const double delta_t_k : plan.target.delta_t_k) {
    TODBENCH_TRY(auto contrast, contrast_of(out.measured, options.speeds_mrad_s, delta_t_k, loaded.sensor(), fit));
    out.contrasts.push_back(std::move(contrast));
  }
  out.time_constant = time_constant_of(out.measured.passes, loaded.sensor().exposure_ms);
  double squares = 0, moved = 0;
  for (const MovingPassRecord& pass : out.measured.passes) {
    if (pass.speed_mrad_s == 0 || !pass.dropped.empty()) continue;
    squares += pass.residual_px * pass.residual_px;
    moved += 1;
  }
  out.residual_px = moved > 0 ? std::sqrt(squares / moved) : 0;
  return out;
}

}  // namespace todbench
