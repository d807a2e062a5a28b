// The 75 % size of a simulated sensor without trials and without a psychometric form: phase-averaged proportion correct
// of the searching observer, interpolated.
#pragma once

#include <stop_token>
#include <vector>

#include "acquisition/core/accuracy.h"
#include "hvs/template_observer.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

struct DirectPoint {
  double delta_t_k = 0;
  double s75_pitch = 0;  ///< in detector pitches
  double standard_error_pitch = 0;
  std::vector<double> sizes_pitch;
  std::vector<double> proportion_correct;
};

struct DirectEstimateOptions {
  int samples_per_pitch = 1;  ///< 2: 2x2 microscan
  Accuracy accuracy;
  std::uint64_t seed = 1;
  std::stop_token stop{};  ///< ends with `interrupted`, within a few hundredths of a second
};

/// One point per contrast (kelvin, > 0). Noise is drawn once per size and shared by phases and contrasts.
/// `invalid_input` when no size between 0.2 and 40 pitches brackets 75 %: the contrast then has no threshold.
[[nodiscard]] Result<std::vector<DirectPoint>> direct_estimate(const SensorSpec& spec, const SensorPlan& plan,
                                                               TemplateObserver& observer,
                                                               const std::vector<double>& delta_t_k,
                                                               const DirectEstimateOptions& options);

}  // namespace todbench
