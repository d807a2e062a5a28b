// SPDX-License-Identifier: GPL-3.0-or-later
// Curves of a simulated sensor without an observer: MRTD after FLIR92, the MTDP-like curve, and the contrast threshold
// of eye, display and sensor for the TTP metric.
#pragma once

#include "sim_devices/sensor/sensor_spec.h"
#include "tod/range/eye_ctf.h"
#include "tod/range/log_linear_curve.h"
#include "tod/range/mrtd_formula.h"

namespace todbench {

/// Parameters of the formulas that do not belong to the sensor.
struct FormulaConditions {
  double snr_threshold = 2.5;
  double eye_integration_s = 0.1;
  EyeConditions eye{};
  double sample_at_eye_mrad = 1;  ///< angle of a displayed sample for the viewer; sets the magnification
  double scene_contrast_k = 10;   ///< scene contrast for the mean luminance of the display; sets the gain
  double alpha_root_hz = 169.6;   ///< calibration of noise in the TTP model of 2004
};

/// Returns the input of the MRTD formula for a sensor: microscan, averaged frames, and the noise vh (fixed pattern), tv
/// (rows) and th (columns). Errors: `invalid_input` (no temporal noise, pixels not square).
[[nodiscard]] Result<MrtdFormula> mrtd_formula_of(const SensorSpec& spec, const FormulaConditions& conditions);

/// Curves of both axes.
struct AxisCurves {
  LogLinearCurve horizontal, vertical;
};
/// Returns the MRTD in kelvin over cycles/mrad, from 1 % to 100 % of the Nyquist frequency of the sampling, where the
/// curve ends by definition. Contains the MTF of optics and detector, but not display and eye.
[[nodiscard]] Result<AxisCurves> mrtd_curves(const SensorSpec& spec, const FormulaConditions& conditions);
/// Returns the MTDP-like curve in kelvin over cycles/mrad. It continues beyond the Nyquist frequency as long as at
/// least two bars are resolved at the best phase and the modulation is above 1 %.
[[nodiscard]] Result<AxisCurves> mtdp_like_curves(const SensorSpec& spec, const FormulaConditions& conditions);
/// Returns the contrast threshold of the system over cycles/mrad, up to the Nyquist frequency: eye / (display x sensor
/// MTF) x sqrt(1 + alpha^2 sigma^2 / S^2), as in the TTP model of 2004. alpha: alpha_root_hz; S: scene_contrast_k;
/// sigma: noise after the channel exp(-2.2 ln^2) of the eye. The result is the geometric mean of both axes.
[[nodiscard]] Result<LogLinearCurve> system_ctf(const SensorSpec& spec, const FormulaConditions& conditions);

}  // namespace todbench
