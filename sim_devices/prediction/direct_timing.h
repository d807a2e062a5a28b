// SPDX-License-Identifier: GPL-3.0-or-later
// Predicted time of a direct estimate on this computer, from a short run of the same work.
#pragma once

#include "hvs/observer/template_observer.h"
#include "sim_devices/prediction/direct_estimate.h"

namespace todbench {

/// Returns the processor time that this thread has used, in seconds. Differences exclude the time of other programs.
[[nodiscard]] double thread_seconds();

/// Returns the processor time in seconds of direct_estimate() for one contrast with a 75 % size near `s75_pitch` and
/// `noise_draws` final draws. Times one size trial with a few draws, which takes some tens of milliseconds, longer for
/// large sizes. Errors as TemplateObserver::bank().
[[nodiscard]] Result<double> measured_direct_seconds(const SensorSpec& spec, const SensorPlan& plan,
                                                     const TemplateObserverSpec& observer, double delta_t_k,
                                                     double s75_pitch, double noise_draws, const Accuracy& accuracy,
                                                     SceneMotion motion);

}  // namespace todbench
