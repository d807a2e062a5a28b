// What a direct estimate will take on this machine, from a moment of the work itself.
#pragma once

#include "hvs/observer/template_observer.h"
#include "sim_devices/prediction/direct_estimate.h"

namespace todbench {

/// Processor time of this thread so far, in seconds: differences do not hold what other programs took.
[[nodiscard]] double thread_seconds();

/// Processor time of direct_estimate() for one contrast whose 75 % size is near `s75_pitch`, with `noise_draws` at the
/// end. Times one size trial with a few draws on this machine; takes some tens of milliseconds, more for large sizes.
/// Errors as TemplateObserver::bank().
[[nodiscard]] Result<double> measured_direct_seconds(const SensorSpec& spec, const SensorPlan& plan,
                                                     const TemplateObserverSpec& observer, double delta_t_k,
                                                     double s75_pitch, double noise_draws, const Accuracy& accuracy,
                                                     SceneMotion motion);

}  // namespace todbench
