// SPDX-License-Identifier: GPL-3.0-or-later
// Dynamic TOD: acuity for a moving target, compared with the acuity for a target at rest.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/enhance/enhancement.h"
#include "sim_devices/prediction/dynamic_trials.h"

namespace todbench {

/// Result of one observer at one speed.
struct DynamicPoint {
  SequenceObserver observer = SequenceObserver::single_frame;
  PsychometricFit fit;  ///< the clusters of the fit are passes
  /// Acuity divided by the acuity of the same observer for the target at rest, paired over whole passes; 1 for the
  /// target at rest. Empty: a threshold is missing.
  std::optional<double> ratio;
  Interval ratio_ci95;
  /// S75 and ratio over the open parameters of an observer with an eye (open_parameters.h). Empty without an eye, or if
  /// there is no value for the observer or at a limit of its open parameters. Not confidence intervals.
  std::optional<std::pair<double, double>> s75_spread_mrad{}, ratio_spread{};
};
/// Results at one speed.
struct DynamicAcuity {
  double speed_mrad_s = 0, speed_px = 0;  ///< speed_px: pixels per frame
  double smear_px = 0;                    ///< speed times time constant
  double exposure_px = 0;                 ///< speed times exposure
  double lag_px = 0;                      ///< mean lag of the picture behind the target, removed before judging
  std::vector<DynamicPoint> points;       ///< one point for each SequenceObserver
};

/// Returns the entry of a speed with its values in pixels of this sensor. The points are empty.
[[nodiscard]] DynamicAcuity dynamic_acuity_at(const SensorSpec& sensor, double speed_mrad_s, double speed_px);
/// Fits the answers of one observer at one speed, and computes the ratio of the acuity to the acuity at rest. Errors:
/// those of fit_psychometric().
[[nodiscard]] Result<DynamicPoint> dynamic_point(SequenceObserver observer, const std::vector<Level>& levels,
                                                 const std::vector<Trial>& trials, const std::vector<Trial>& at_rest,
                                                 const FitOptions& fit);

/// Adds the spread over the open parameters to the points of an observer. `ends`: best and worst observer, with the
/// same speeds and kinds as `found`.
void add_spreads(const std::array<std::vector<DynamicAcuity>, 2>& ends, std::vector<DynamicAcuity>& found);

/// Results at all speeds.
struct DynamicAcuities {
  std::vector<DynamicAcuity> speeds;
  std::vector<std::string> notes;  ///< reasons for missing spreads
};

/// Computes the acuities with dynamic_trials(). Adds the speed 0 in front if it is missing. If `options` state no
/// sizes, uses eleven sizes from 0.5 to 2.5 times the threshold of the target at rest. A direct estimate computes this
/// threshold. For an observer with an eye, also computes the observers at both limits of its open parameters, each with
/// its own sizes.
[[nodiscard]] Result<DynamicAcuities> dynamic_acuity(const SensorSpec& sensor, TemplateObserver& observer,
                                                     DynamicTrialOptions options);

}  // namespace todbench
