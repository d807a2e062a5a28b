// SPDX-License-Identifier: GPL-3.0-or-later
// Dynamic TOD: acuity for a moving target, compared with that for a target at rest.
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
  PsychometricFit fit;  ///< clusters are passes
  /// Acuity over that of the same observer for the target at rest, paired over whole passes; empty: a threshold is
  /// missing. 1 for the target at rest.
  std::optional<double> ratio;
  Interval ratio_ci95;
  /// S75 and ratio over the open parameters of an observer with an eye (open_parameters.h); empty without an eye, or if
  /// the observer or an end has none. No confidence intervals.
  std::optional<std::pair<double, double>> s75_spread_mrad{}, ratio_spread{};
};
struct DynamicAcuity {
  double speed_mrad_s = 0, speed_px = 0;  ///< pixels per frame
  double smear_px = 0;                    ///< speed times time constant
  double exposure_px = 0;                 ///< speed times exposure
  double lag_px = 0;                      ///< mean lag, removed before judging
  std::vector<DynamicPoint> points;       ///< by SequenceObserver
};

/// Converts a speed to this sensor's pixels; the points are empty.
[[nodiscard]] DynamicAcuity dynamic_acuity_at(const SensorSpec& sensor, double speed_mrad_s, double speed_px);
/// Fits the answers of one observer at one speed, and their ratio to those at rest. As fit_psychometric().
[[nodiscard]] Result<DynamicPoint> dynamic_point(SequenceObserver observer, const std::vector<Level>& levels,
                                                 const std::vector<Trial>& trials, const std::vector<Trial>& at_rest,
                                                 const FitOptions& fit);

/// Adds the spreads between both ends of the open parameters to the points of an observer: best and worst, with the
/// same speeds and kinds.
void add_spreads(const std::array<std::vector<DynamicAcuity>, 2>& ends, std::vector<DynamicAcuity>& found);

struct DynamicAcuities {
  std::vector<DynamicAcuity> speeds;
  std::vector<std::string> notes;  ///< reasons of missing spreads
};

/// Calls dynamic_trials() with its options; adds the speed 0 in front if it is missing. Without sizes: eleven from 0.5
/// to 2.5 times the threshold of the target at rest, from a direct estimate. An observer with an eye is followed by
/// those at both ends of its open parameters, each with its own sizes.
[[nodiscard]] Result<DynamicAcuities> dynamic_acuity(const SensorSpec& sensor, TemplateObserver& observer,
                                                     DynamicTrialOptions options);

}  // namespace todbench
