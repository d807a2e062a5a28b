// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/plan.h"

#include <algorithm>
#include <cmath>

#include "acquisition/base/normal.h"
#include "acquisition/base/safe_text.h"
#include "bench/plan/joined_uncertainty.h"

namespace todbench {
namespace {

/// Returns the standard uncertainty with infinite degrees of freedom that gives the same 95 % interval.
double widened(const JoinedUncertainty& joined) {
  return joined.half_width(0.025) / normal_z95;
}

}  // namespace

InstrumentRole role_of(const InstrumentPlan& instrument) {
  if (instrument.role != InstrumentRole::by_name) return instrument.role;
  const std::string name = lower_case(instrument.name);
  for (const InstrumentRole role : {InstrumentRole::black_body, InstrumentRole::plate_stage})
    if (name.find(to_string(role)) != std::string::npos) return role;
  return InstrumentRole::other;
}

std::string_view to_string(ScheduleKind kind) {
  switch (kind) {
    case ScheduleKind::adaptive:
      return "adaptive";
    case ScheduleKind::ramp:
      return "ramp";
    default:
      return "constant";
  }
}

std::string_view to_string(AnswersChoice choice) {
  switch (choice) {
    case AnswersChoice::automatic:
      return "automatic";
    case AnswersChoice::binary:
      return "binary";
    case AnswersChoice::graded:
      return "graded";
  }
  return "unknown";
}

std::string_view to_string(EstimatorChoice choice) {
  switch (choice) {
    case EstimatorChoice::automatic:
      return "automatic";
    case EstimatorChoice::weibull:
      return to_string(FitEstimator::weibull);
    case EstimatorChoice::twin_shape:
      return to_string(FitEstimator::twin_shape);
  }
  return "unknown";
}

std::string_view to_string(TargetKind kind) {
  switch (kind) {
    case TargetKind::scpi:
      return "scpi";
    case TargetKind::prompt:
      return "prompt";
    case TargetKind::scene:
      return "scene";
    case TargetKind::display:
      return "display";
  }
  return "";
}

std::string_view to_string(ConformityRule rule) {
  switch (rule) {
    case ConformityRule::guarded_acceptance_and_rejection:
      return "guarded_acceptance_and_rejection";
    case ConformityRule::simple:
      return "simple";
    case ConformityRule::guarded:
      return "guarded";
    case ConformityRule::non_binary:
      return "non_binary";
  }
  return "";
}

std::size_t mountings_of(const TargetPlan& target, std::size_t plate) {
  const std::vector<int>& counts = target.mountings_per_plate;
  const int count = counts.size() == 1 ? counts[0] : plate < counts.size() ? counts[plate] : 0;
  return count > 0 ? std::min(static_cast<std::size_t>(count), target.mountings.size()) : target.mountings.size();
}

std::size_t set_ups_of(const TargetPlan& target) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < target.plates.size(); ++i) count += mountings_of(target, i);
  return count;
}

bool MeasuresPlan::any() const {
  return std::any_of(measure_keys.begin(), measure_keys.end(),
                     [&](const MeasureKey& key) { return this->*key.requested; });
}

double relative_u_of_scale(const Plan& plan) {
  double largest_k = 0;
  JoinedUncertainty sum;
  for (const double step_k : plan.measures.transfer_steps_k) largest_k = std::max(largest_k, std::abs(step_k));
  for (const BudgetRow& row : plan.uncertainty.rows) {
    const BudgetInput input = input_of(row);
    if (kind_of(input) != InputKind::contrast || input == BudgetInput::camera_scale || row.sensitivity) continue;
    const BudgetUnit unit = budget_unit(InputKind::contrast, row.unit).value_or(BudgetUnit{});
    sum.add(standard_of(row) * unit.factor / (unit.relative || !(largest_k > 0) ? 1 : largest_k),
            row.degrees_of_freedom);
  }
  return widened(sum);
}

double relative_u_of_camera_scale(const Plan& plan) {
  JoinedUncertainty sum;
  for (const BudgetRow& row : plan.uncertainty.rows) {
    const BudgetUnit unit = budget_unit(InputKind::contrast, row.unit).value_or(BudgetUnit{});
    if (input_of(row) != BudgetInput::camera_scale || row.sensitivity || !unit.relative) continue;
    sum.add(standard_of(row) * unit.factor, row.degrees_of_freedom);
  }
  return widened(sum);
}

double relative_u_of_distance(const Plan& plan) {
  JoinedUncertainty sum;
  for (const BudgetRow& row : plan.uncertainty.rows) {
    const BudgetInput input = input_of(row);
    if ((input != BudgetInput::distance && input != BudgetInput::entrance_pupil) || row.sensitivity) continue;
    const BudgetUnit unit = budget_unit(InputKind::geometry, row.unit).value_or(BudgetUnit{});
    sum.add(standard_of(row) * unit.factor / (unit.relative ? 1 : plan.target.distance_m), row.degrees_of_freedom);
  }
  return widened(sum);
}

double known_u_of_acuity(const Plan& plan, BudgetCommon common) {
  double sum = 0;
  for (const BudgetRow& row : plan.uncertainty.rows) {
    if (std::find(row.common.begin(), row.common.end(), common) != row.common.end()) continue;
    const BudgetInput input = input_of(row);
    const auto unit = budget_unit(kind_of(input), row.unit);
    double sensitivity = 0;
    if (row.sensitivity)
      sensitivity = std::abs(*row.sensitivity);
    else if (unit && kind_of(input) != InputKind::contrast && (unit->relative || input != BudgetInput::cut_outs))
      sensitivity = unit->relative ? unit->factor : unit->factor / plan.target.distance_m;
    sum = std::hypot(sum, sensitivity * standard_of(row));
  }
  return sum;
}

}  // namespace todbench
