// SPDX-License-Identifier: GPL-3.0-or-later
// Curves from presentations whose contrasts are measured from their own frames: within a settling band, or in a ramp.
#pragma once

#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "bench/twin/experiment_inputs.h"
#include "tod/measurement/measurement.h"
#include "tod/psychometric/contrast_surface.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Returns the function of the simulated sensor over size and contrast, for the contrasts of the plan and a quarter
/// beyond the lowest and the highest contrast. One table takes about a second. Errors: those of proportion_curves().
[[nodiscard]] Result<ContrastSurface> contrast_surface(const Plan& plan, const ExperimentInputs& inputs,
                                                       std::stop_token stop);

/// Returns the answers converted to their set contrasts: the set contrast c replaces the observed contrast c', and the
/// size S becomes S exp(g(c) - g(c')). g is the ln S75 of the surface, and c the set contrast that the camera observes
/// through the stated air.
[[nodiscard]] std::vector<Trial> at_set_contrasts(std::span<const Trial> trials, const ContrastSurface& surface,
                                                  double air_transmittance);

/// Notes and finding of a ramp, in addition to its curve.
struct RampOutcome {
  std::vector<std::string> notes{};
  std::vector<AdequacyFinding> findings{};  ///< `ramp_direction`, `contrast_lag`
};

/// Sets threshold and interval of the points of a curve to the values of the fit over all contrasts of a ramp, and adds
/// the continuous curve. `run`: with the observed contrasts. `curve`: from the answers of at_set_contrasts(). Errors:
/// those of RampFit::of().
[[nodiscard]] Result<RampOutcome> take_ramp(TodCurve& curve, const MeasurementResult& run,
                                            const ContrastSurface& surface, const Plan& plan);

/// Returns the change of ln S75 per unit of ln contrast, for an error of the contrast that small and large triangles do
/// not share. This is the slope of the curve, at least 0.2. The minimum accounts for the internal noise of the
/// observer, which this error also changes.
[[nodiscard]] double sensitivity_to_lag(const ContrastSurface& surface, double delta_t_k);

/// Numbers of contrasts of a ramp: shown contrasts, and contrasts skipped because of a correction or another wait.
struct LostContrasts {
  int shown = 0, lost = 0;
};
/// Counts gaps between successive presentations of a set-up above 2.5 `ln_step`, a step of the ramp in ln contrast.
[[nodiscard]] LostContrasts lost_contrasts(std::span<const Presentation> presentations, double ln_step);

}  // namespace todbench
