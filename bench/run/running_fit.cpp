// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run/running_fit.h"

#include <utility>

#include "bench/plan/plan_options.h"
#include "bench/twin/twin_shapes.h"

namespace todbench {
namespace {

/// Assumed error of the answers so far: 1000 draws, whose error of 1 % is added to theirs.
constexpr double error_so_far = 0.05;

}  // namespace

bool RunningFit::prepare(const std::stop_token& stop) {
  if (functions_) return true;
  std::map<double, ProportionTable> none;
  const auto loaded = LoadedPlan::load(plan_);
  EffectPlanner planner;
  const auto inputs = loaded ? experiment_inputs(*loaded, planner) : tl::unexpected(loaded.error());
  auto tables = inputs ? twin_tables(plan_, *inputs, error_so_far, stop) : std::move(none);
  if (!tables) return false;
  functions_ = *std::move(tables);
  return true;
}

std::optional<TodCurve> RunningFit::curve_of(std::span<const Trial> trials, const std::stop_token& stop) {
  if (trials.empty() || !prepare(stop)) return std::nullopt;
  FitOptions options = fit_options(plan_);
  options.with_posterior = false;  // only reports show the posterior
  auto curve = tod_curve(trials, options);
  if (!curve) return std::nullopt;
  fit_with_tables(*curve, trials, *functions_, options);
  return *std::move(curve);
}

}  // namespace todbench
