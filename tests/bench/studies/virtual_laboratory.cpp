// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/studies/virtual_laboratory.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "acquisition/base/rng.h"
#include "acquisition/core/forwarding_source.h"
#include "bench/judgement/acuity_uncertainty.h"
#include "bench/plan/plan_options.h"
#include "bench/twin/simulated_responses.h"
#include "bench/twin/twin_shapes.h"
#include "tod/adequacy/adequacy.h"
#include "tod/measurement/measurement.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

/// Draws an error in the unit of the row.
double drawn_error(const BudgetRow& row, const RandomStream& random) {
  constexpr double pi = std::numbers::pi;
  switch (row.distribution) {
    case BudgetDistribution::normal:
      return standard_of(row) * random.normal(0);
    case BudgetDistribution::rectangular:
      return row.value * (2 * random.uniform(0) - 1);
    case BudgetDistribution::triangular:
      return row.value * (random.uniform(0) + random.uniform(1) - 1);
    case BudgetDistribution::u_shaped:
      return row.value * std::cos(2 * pi * random.uniform(0));
  }
  return 0;
}

double with_error(double stated, const InputError& error) {
  return stated * (1 + error.relative) + error.absolute;
}

/// A camera with a wrong scale for all temperature differences to `reference_k`.
class WronglyScaledSource final : public ForwardingSource {
 public:
  WronglyScaledSource(std::unique_ptr<FrameSource> source, double factor, double reference_k)
      : ForwardingSource(std::move(source)), info_(ForwardingSource::info()) {
    if (const LinearScale* line = info_.scale.straight_line()) {
      info_.scale = RadiometricScale::linear({.kelvin_per_count = factor * line->kelvin_per_count,
                                              .offset_k = reference_k + factor * (line->offset_k - reference_k)})
                        .value();
    }
    scale_ = std::make_shared<const RadiometricScale>(info_.scale);
  }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds timeout) override {
    auto frame = ForwardingSource::next(timeout);
    if (frame) frame->scale = scale_;
    return frame;
  }

 private:
  SourceInfo info_;
  std::shared_ptr<const RadiometricScale> scale_;
};

/// Reports the set state, regardless of the shown one.
class UnknowingTarget final : public Target {
 public:
  explicit UnknowingTarget(std::unique_ptr<Target> target) : target_(std::move(target)) {}
  [[nodiscard]] const TargetCapabilities& capabilities() const override { return target_->capabilities(); }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    auto shown = target_->present(state, std::move(stop));
    if (shown) shown->state = state;
    return shown;
  }

 private:
  std::unique_ptr<Target> target_;
};

/// Measures like a session with its camera.
Result<MeasurementResult> measured_on(OpenedBench& bench, const Plan& plan, const ExperimentInputs& inputs,
                                      const std::stop_token& stop) {
  MeasurementOptions options = measurement_options(plan, inputs.plates, plan.camera.ifov_mrad);
  // A plan that names neither has binary answers and a Weibull function here.
  if (plan.schedule.answers == AnswersChoice::graded) take_answers(options, plan, inputs);
  options.free_running = !bench.simulated;
  const SensorModel model(inputs.sensor, inputs.effects, inputs.accuracy, plan.seed);
  auto response = simulated_responses(model, plan, inputs.plates, options, stop);
  if (!response) return tl::unexpected(response.error());
  options.contrast_response = *std::move(response);
  TemplateObserver observer(inputs.observer, triangle_alternatives());
  const auto schedule =
      make_schedule(plan, inputs.plates, plan.camera.ifov_mrad, Side::measured, RandomStream(plan.seed, "schedule"));
  auto result = measure(*bench.camera, *bench.target, observer, *schedule, options, *bench.host, {}, stop);
  if (result && result->ended_by) return tl::unexpected(*result->ended_by);
  return result;
}

/// The row of the finite trials, if there is one.
const AppliedRow* trials_of(const PointUncertainty& budget) {
  const auto row = std::find_if(budget.rows.begin(), budget.rows.end(),
                                [](const AppliedRow& one) { return one.row.name == finite_trials_row; });
  return row != budget.rows.end() ? &*row : nullptr;
}

/// Points of the contrasts with a threshold and a closed interval.
std::vector<LaboratoryPoint> points_of(std::uint64_t laboratory, const TodCurve& curve,
                                       const CurveUncertainty& uncertainty) {
  std::vector<LaboratoryPoint> points;
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const TodPoint& point = curve.points[i];
    const PointUncertainty& budget = uncertainty.points[i];
    const Interval &statistical = budget.statistical_mrad, &expanded = budget.expanded_mrad;
    const AppliedRow* trials = trials_of(budget);
    if (!point.fit.threshold || !budget.combined || !trials || !expanded.low || !expanded.high) continue;
    points.push_back({.laboratory = laboratory,
                      .delta_t_k = point.set_delta_t_k,
                      .seen_delta_t_k = point.delta_t_k,
                      .s75_mrad = *point.fit.threshold,
                      .statistical_low = *statistical.low,
                      .statistical_high = *statistical.high,
                      .low = *expanded.low,
                      .high = *expanded.high,
                      .u = budget.combined->u,
                      .degrees_of_freedom = budget.combined->nu_eff,
                      .contrast_slope = budget.contrast_slope,
                      .u_trials = trials->standard_uncertainty,
                      .trials_freedom = trials->row.degrees_of_freedom});
  }
  return points;
}

}  // namespace

LaboratoryErrors drawn_errors(const Plan& plan, std::uint64_t seed, std::uint64_t laboratory) {
  const RandomStream random = RandomStream(seed, "virtual laboratory").sub(laboratory);
  LaboratoryErrors errors;
  errors.contrasts_k.resize(plan.target.delta_t_k.size());
  const auto add = [](InputError& to, const BudgetUnit& unit, double error) {
    (unit.relative ? to.relative : to.absolute) += unit.factor * error;
  };
  for (std::size_t r = 0; r < plan.uncertainty.rows.size(); ++r) {
    const BudgetRow& row = plan.uncertainty.rows[r];
    const BudgetInput input = input_of(row);
    const InputKind kind = kind_of(input);
    const auto unit = budget_unit(kind, row.unit);
    if (kind == InputKind::direct || input == BudgetInput::ifov || !unit) continue;
    const RandomStream of_row = random.sub(r);
    const double error = drawn_error(row, of_row);
    if (input == BudgetInput::camera_scale) {
      add(errors.camera_scale, *unit, error);
    } else if (kind == InputKind::contrast) {
      for (std::size_t c = 0; c < errors.contrasts_k.size(); ++c) {
        const bool anew = input == BudgetInput::black_body_stability;
        add(errors.contrasts_k[c], *unit, anew ? drawn_error(row, of_row.sub(c)) : error);
      }
    } else if (input == BudgetInput::cut_outs) {
      add(errors.cut_outs_m, *unit, error);
    } else {
      add(errors.distance_m, *unit, error);
    }
  }
  return errors;
}

RealSetUp real_set_up(const Plan& plan, const ExperimentInputs& inputs, const LaboratoryErrors& errors) {
  RealSetUp real{.plates = inputs.plates,
                 .distance_m = with_error(plan.target.distance_m, errors.distance_m),
                 .camera_scale = 1 + errors.camera_scale.relative};
  for (TargetPlate& plate : real.plates) {
    for (PlateTriangle& triangle : plate.triangles)
      triangle.size_mm = 1e3 * with_error(1e-3 * triangle.size_mm, errors.cut_outs_m);
  }
  for (std::size_t c = 0; c < plan.target.delta_t_k.size(); ++c) {
    const double told = plan.target.delta_t_k[c];
    real.shown_k[told] = with_error(told, errors.contrasts_k[c]);
  }
  return real;
}

OpenedBench erring_bench(const Plan& plan, const ExperimentInputs& inputs, const LaboratoryErrors& errors,
                         std::uint64_t seed) {
  const RealSetUp real = real_set_up(plan, inputs, errors);
  const auto model = std::make_shared<const SensorModel>(inputs.sensor, inputs.effects, inputs.accuracy, seed);
  OpenedBench bench = simulated_bench(model, real.plates, real.distance_m, real.shown_k);
  bench.target = std::make_unique<UnknowingTarget>(std::move(bench.target));
  bench.camera = std::make_unique<WronglyScaledSource>(std::move(bench.camera), real.camera_scale,
                                                       inputs.sensor.scene_temperature_k);
  return bench;
}

Plan plan_of_laboratory(Plan of_all, std::uint64_t laboratory) {
  of_all.seed += 2 * laboratory;
  return of_all;
}

Result<std::vector<LaboratoryPoint>> measured_on_bench(OpenedBench& bench, const Plan& plan,
                                                       const ExperimentInputs& inputs, std::uint64_t laboratory,
                                                       std::stop_token stop) {
  if (!plan.uncertainty.stated())
    return fail(ErrorCode::invalid_input,
                "[uncertainty] states no budget, so the virtual laboratories would have no errors");
  const auto measured = measured_on(bench, plan, inputs, stop);
  if (!measured) return tl::unexpected(measured.error());
  auto curve = tod_curve(measured->trials, fit_options(plan));
  if (!curve) return tl::unexpected(curve.error());
  if (plan.fit.estimator == EstimatorChoice::twin_shape) {
    std::map<double, double> shown;
    for (const TodPoint& point : curve->points) shown[point.set_delta_t_k] = point.delta_t_k;
    auto outcome = fit_twin_shapes(*curve, measured->trials, inputs, fit_options(plan),
                                   direct_options(*curve, inputs, shown, plan.seed, std::move(stop)));
    if (outcome.ended_by) return tl::unexpected(*std::move(outcome.ended_by));
  }
  examine(*curve, fit_options(plan));
  const auto uncertainty = curve_uncertainty(plan, *curve, measured->presentations, std::nullopt);
  if (!uncertainty) return tl::unexpected(uncertainty.error());
  return points_of(laboratory, *curve, **uncertainty);
}

Result<std::vector<LaboratoryPoint>> measured_by_laboratory(const Plan& of_all, const ExperimentInputs& inputs,
                                                            std::uint64_t laboratory, std::stop_token stop) {
  const Plan plan = plan_of_laboratory(of_all, laboratory);
  OpenedBench bench = erring_bench(plan, inputs, drawn_errors(plan, of_all.seed, laboratory), plan.seed + 1);
  return measured_on_bench(bench, plan, inputs, laboratory, std::move(stop));
}

double normalised_error(const LaboratoryPoint& a, const LaboratoryPoint& b) {
  const double difference = std::log(a.s75_mrad / b.s75_mrad);
  const auto towards = [&](const LaboratoryPoint& one, bool up) {
    return up ? std::log(one.high / one.s75_mrad) : std::log(one.s75_mrad / one.low);
  };
  return difference / std::hypot(towards(a, difference < 0), towards(b, difference > 0));
}

}  // namespace todbench
