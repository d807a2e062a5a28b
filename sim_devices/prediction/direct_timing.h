// SPDX-License-Identifier: GPL-3.0-or-later
// Predicted time of a direct estimate on this computer, from a short run of the same work.
#pragma once

#include "hvs/observer/template_observer.h"
#include "sim_devices/prediction/direct_estimate.h"

namespace todbench {

/// Returns the processor time that the calling thread has used so far, in seconds. The difference of two values does
/// not include the time of other threads or programs.
[[nodiscard]] double thread_seconds();

/// Predicts the processor time of direct_estimate() for one contrast, in seconds. `s75_pitch`: expected 75 % size;
/// `noise_draws`: number of draws of noise for each of the final sizes. The function evaluates one size with a few
/// draws, measures the time, and scales this time to the whole estimate. The measurement takes some tens of
/// milliseconds, longer for large sizes. Errors: those of TemplateObserver::bank().
[[nodiscard]] Result<double> measured_direct_seconds(const SensorSpec& spec, const SensorPlan& plan,
                                                     const TemplateObserverSpec& observer, double delta_t_k,
                                                     double s75_pitch, double noise_draws, const Accuracy& accuracy,
                                                     SceneMotion motion);

}  // namespace todbench
