// Dynamic TOD: acuity before a target that moves, beside that before one that rests.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "bench/enhance/enhancement.h"
#include "sim_devices/prediction/dynamic_trials.h"

namespace todbench {

/// One observer at one speed.
struct DynamicPoint {
  SequenceObserver observer = SequenceObserver::single_frame;
  PsychometricFit fit;  ///< clusters are passes
  /// Acuity over that of the same observer before a target that rests, paired over whole passes; nothing: a threshold
  /// is missing. Of the resting target itself 1.
  std::optional<double> ratio;
  Interval ratio_ci95;
};
struct DynamicAcuity {
  double speed_mrad_s = 0, speed_px = 0;  ///< pixels per frame
  double smear_px = 0;                    ///< speed times time constant
  double exposure_px = 0;                 ///< speed times exposure
  double lag_px = 0;                      ///< mean lag that was taken out
  std::vector<DynamicPoint> points;       ///< by SequenceObserver
};

/// Speeds of a target in this sensor's pixels; no points yet.
[[nodiscard]] DynamicAcuity dynamic_acuity_at(const SensorSpec& sensor, double speed_mrad_s, double speed_px);
/// The fit of the answers of one observer at one speed, and their ratio to those at rest. Errors: fit_psychometric()'s.
[[nodiscard]] Result<DynamicPoint> dynamic_point(SequenceObserver observer, const std::vector<Level>& levels,
                                                 const std::vector<Trial>& trials, const std::vector<Trial>& at_rest,
                                                 const FitOptions& fit);

/// As dynamic_trials() with its options; a speed of 0 is added in front where it is missing. Without sizes: eleven from
/// 0.5 to 2.5 times the threshold of the resting target by a direct estimate.
[[nodiscard]] Result<std::vector<DynamicAcuity>> dynamic_acuity(const SensorSpec& sensor, TemplateObserver& observer,
                                                                DynamicTrialOptions options);

}  // namespace todbench
