// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/signal_transfer.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "acquisition/base/distributions.h"
#include "acquisition/base/try.h"

namespace todbench {
namespace {

Result<void> check(std::span<const TemperatureStep> steps) {
  if (steps.size() < 3) {
    return fail(ErrorCode::invalid_input,
                "a signal transfer needs at least three steps, found " + std::to_string(steps.size()));
  }
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const TemperatureStep& step = steps[i];
    const std::string name = "step " + std::to_string(i + 1);
    if (!std::isfinite(step.delta_t_k) || !std::isfinite(step.signal))
      return fail(ErrorCode::invalid_input, name + " contains a value that is not finite");
    if (step.signal_u.has_value() != steps[0].signal_u.has_value())
      return fail(ErrorCode::invalid_input, name + ": state an uncertainty for all steps or for none");
    if (step.signal_u && !(std::isfinite(*step.signal_u) && *step.signal_u > 0))
      return fail(ErrorCode::invalid_input, name + ": the uncertainty of the signal must be above 0");
  }
  return {};
}

}  // namespace

Result<SignalTransfer> signal_transfer(std::span<const TemperatureStep> steps) {
  TODBENCH_TRY_VOID(check(steps));
  const auto [least, most] = std::minmax_element(
      steps.begin(), steps.end(), [](const auto& a, const auto& b) { return a.delta_t_k < b.delta_t_k; });
  const double span_k = most->delta_t_k - least->delta_t_k;
  // Steps that differ by rounding only count as one step.
  if (!(span_k > 1e-9 * std::max(std::abs(least->delta_t_k), std::abs(most->delta_t_k))))
    return fail(ErrorCode::invalid_input, "the steps have no spread: all are at the same temperature");
  // The smallest uncertainty has the weight 1, so that no representable uncertainty makes a weight overflow.
  double unit = 1;
  if (steps[0].signal_u) {
    unit = *steps[0].signal_u;
    for (const auto& step : steps) unit = std::min(unit, *step.signal_u);
  }
  const auto weight = [&](const TemperatureStep& step) { return std::pow(unit / step.signal_u.value_or(unit), 2); };
  double sum = 0, x_mean = 0, y_mean = 0;
  for (const auto& step : steps) {
    const double w = weight(step);
    sum += w, x_mean += w * (step.delta_t_k - least->delta_t_k), y_mean += w * (step.signal - steps[0].signal);
  }
  x_mean = least->delta_t_k + x_mean / sum, y_mean = steps[0].signal + y_mean / sum;
  double xx = 0, xy = 0, yy = 0;
  for (const auto& step : steps) {
    const double w = weight(step), x = step.delta_t_k - x_mean, y = step.signal - y_mean;
    xx += w * x * x, xy += w * x * y, yy += w * y * y;
  }
  // All of the weight may be at one temperature.
  if (!(xx > 0) || !std::isfinite(xx) || !std::isfinite(yy))
    return fail(ErrorCode::invalid_input,
                "the steps have no spread after weighting: their uncertainties differ too much");
  if (!(yy > 0)) return fail(ErrorCode::invalid_input, "the signal is the same at every step");
  SignalTransfer line;
  line.slope = xy / xx;
  line.offset = y_mean - line.slope * x_mean;
  line.degrees_of_freedom = static_cast<int>(steps.size()) - 2;
  double squares = 0;
  for (const auto& step : steps) {
    const double residual = step.signal - y_mean - line.slope * (step.delta_t_k - x_mean);
    squares += weight(step) * residual * residual;
    line.largest_residual = std::max(line.largest_residual, std::abs(residual));
    line.residuals.push_back(residual);
  }
  line.slope_u_scatter = std::sqrt(squares / line.degrees_of_freedom / xx);
  line.slope_u = line.slope_u_scatter;
  if (steps[0].signal_u) {
    line.slope_u_stated = unit / std::sqrt(xx);
    line.slope_u = std::max(*line.slope_u_stated, line.slope_u_scatter);
    line.chi2 = squares / unit / unit;
    if (!std::isfinite(*line.chi2))
      return fail(ErrorCode::invalid_input, "the stated uncertainties are too small for the residuals");
    line.p = cdf(complement(distribution::ChiSquared(line.degrees_of_freedom), *line.chi2));
  }
  if (!std::isfinite(line.slope) || !std::isfinite(line.offset) || !std::isfinite(line.slope_u) || line.slope == 0)
    return fail(ErrorCode::invalid_input, "the steps do not determine a slope");
  line.nonlinearity_percent = 100 * line.largest_residual / (std::abs(line.slope) * span_k);
  line.r_squared = 1 - squares / yy;
  return line;
}

}  // namespace todbench
