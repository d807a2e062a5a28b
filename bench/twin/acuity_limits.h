// SPDX-License-Identifier: GPL-3.0-or-later
// What limits the acuity of a simulated sensor with its display and observer: sampling, noise, display, eye or light.
#pragma once

#include <optional>
#include <stop_token>
#include <vector>

#include "bench/session/display_record.h"
#include "bench/twin/experiment_inputs.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Leaves out one factor after the other, by direct estimates of draft accuracy (error about 1 %): sampling: twice as
/// many samples at the same size on the display; noise: none; display: no spot, veil or interpolation, black of 0 and
/// the largest contrast; eye: no noise of its own; light: a hundred times the luminance. Contrasts without a threshold
/// are left out. Errors: `interrupted`; `invalid_input` if the plan or its sensor has modules.
[[nodiscard]] Result<std::vector<AcuityLimits>> acuity_limits(const Plan& plan, const ExperimentInputs& inputs,
                                                              const std::vector<double>& delta_t_k,
                                                              std::stop_token stop);

/// What stands beside the results of a curve: for an observer with an eye what limits its acuity; for another, if the
/// plan asks for it, also the thresholds of hvs-2 at the display of the plan. Behind the simulated sensor. Empty:
/// neither, or the plan has modules. Errors: `interrupted`, and those of the observer's file.
[[nodiscard]] Result<std::optional<DisplayRecord>> at_display(const TodCurve& curve, const ExperimentInputs& inputs,
                                                              const Plan& plan, std::stop_token stop);

}  // namespace todbench
