// SPDX-License-Identifier: GPL-3.0-or-later
// Factors that limit the acuity of a simulated sensor with its display and observer: sampling, noise, display, eye or
// light.
#pragma once

#include <optional>
#include <stop_token>
#include <vector>

#include "bench/session/display_record.h"
#include "bench/twin/experiment_inputs.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Computes the cost of each factor with direct estimates of draft accuracy (error about 1 %), from a variant without
/// the factor. Sampling: half the sample distance, at the same size on the display. Noise: a sensor without noise.
/// Display: no spot, veil and interpolation, black at 0 and the largest contrast. Eye: no noise of the eye. Observer
/// without an eye: almost no blur and no internal noise. Light: a hundred times the luminance. Contrasts without a
/// threshold are left out. Errors: `interrupted`; `invalid_input` if the plan or its sensor has modules.
[[nodiscard]] Result<std::vector<AcuityLimits>> acuity_limits(const Plan& plan, const ExperimentInputs& inputs,
                                                              const std::vector<double>& delta_t_k,
                                                              std::stop_token stop);

/// Returns the factors that limit the acuity of an observer with an eye that views the pictures of the simulated
/// sensor. If the observer of the plan has no eye but the plan sets `display_as_operator`, the observer is hvs-2 at the
/// display of the plan, and its thresholds are added. Empty if neither applies, or if the plan has modules. Errors:
/// `interrupted`, and those of the observer's file.
[[nodiscard]] Result<std::optional<DisplayRecord>> at_display(const TodCurve& curve, const ExperimentInputs& inputs,
                                                              const Plan& plan, std::stop_token stop);

}  // namespace todbench
