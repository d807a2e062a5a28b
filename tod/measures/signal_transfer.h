// SPDX-License-Identifier: GPL-3.0-or-later
// Signal transfer (SiTF): straight line through the camera's response to temperature steps.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// One step: the set temperature and the camera's response.
struct TemperatureStep {
  double delta_t_k = 0;              ///< effective contrast, or a black body's temperature
  double signal = 0;                 ///< mean response, in counts or in the unit of the camera
  std::optional<double> signal_u{};  ///< standard uncertainty of the signal; stated for all steps or for none
};

/// The line signal = offset + slope delta_t_k, by least squares with the weights 1 / signal_u^2 (equal weights if not
/// stated).
struct SignalTransfer {
  double slope = 0;    ///< signal per kelvin
  double offset = 0;   ///< signal at delta_t_k = 0
  double slope_u = 0;  ///< standard uncertainty: the larger value of slope_u_stated and slope_u_scatter
  std::optional<double> slope_u_stated{};  ///< standard uncertainty of the slope from the stated uncertainties
  double slope_u_scatter = 0;              ///< standard uncertainty of the slope from the residuals
  std::optional<double> chi2{};            ///< chi-square of the residuals with the stated uncertainties
  int degrees_of_freedom = 0;
  std::optional<double> p{};        ///< probability of a larger chi2 if the transfer is a straight line
  double largest_residual = 0;      ///< largest magnitude of a residual, in the unit of the signal
  double nonlinearity_percent = 0;  ///< largest residual divided by the span of the line between the outermost steps
  /// Coefficient of determination; not a measure of linearity: it is 0.9999 even for a nonlinearity of 1 %.
  double r_squared = 0;
  std::vector<double> residuals{};  ///< residual of each step
};

/// Fits the line. Errors: `invalid_input` (fewer than three steps, steps without spread, a value that is not finite, an
/// uncertainty that is not positive or is stated for some steps only, or a constant signal).
[[nodiscard]] Result<SignalTransfer> signal_transfer(std::span<const TemperatureStep> steps);

}  // namespace todbench
