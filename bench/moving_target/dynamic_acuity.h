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
  /// Acuity over that of the same observer for the target at rest, paired over whole passes; 1 for the target at rest.
  /// Empty: a threshold is missing.
  std::optional<double> ratio;
  Interval ratio_ci95;
  /// S75 and ratio over the open parameters of an observer with an eye (open_parameters.h); empty without an eye, or if
  /// the observer or a limit of its parameters gives none. Not confidence intervals.
  std::optional<std::pair<double, double>> s75_spread_mrad{}, ratio_spread{};
};
/// Results at one speed.
struct DynamicAcuity {
  double speed_mrad_s = 0, speed_px = 0;  ///< pixels per frame
  double smear_px = 0;                    ///< speed times time constant
  double exposure_px = 0;                 ///< speed times exposure
  double lag_px = 0;                      ///< mean lag, removed before judging
  std::vector<DynamicPoint> points;       ///< by SequenceObserver
};

/// Converts a speed to the pixels of this sensor. The points are empty.
[[nodiscard]] DynamicAcuity dynamic_acuity_at(const SensorSpec& sensor, double speed_mrad_s, double speed_px);
/// Fits the answers of one observer at one speed, and computes their ratio to those at rest. Errors: those of
/// fit_psychometric().
[[nodiscard]] Result<DynamicPoint> dynamic_point(SequenceObserver observer, const std::vector<Level>& levels,
                                                 const std::vector<Trial>& trials, const std::vector<Trial>& at_rest,
                                                 const FitOptions& fit);

/// Adds the spreads between both limits of the open parameters to the points of an observer. `ends`: best and worst
/// observer, with the same speeds and kinds as `found`.
void add_spreads(const std::array<std::vector<DynamicAcuity>, 2>& ends, std::vector<DynamicAcuity>& found);

/// Results at all speeds.
struct DynamicAcuities {
  std::vector<DynamicAcuity> speeds;
  std::vector<std::string> notes;  ///< reasons of missing spreads
};

/// Calls dynamic_trials() with its options; adds the speed 0 in front if it is missing. Without sizes: eleven from 0.5
/// to 2.5 times the threshold of the target at rest, from a direct estimate. For an observer with an eye, the observers
/// at both limits of its open parameters follow, each with its own sizes.
[[nodiscard]] Result<DynamicAcuities> dynamic_acuity(const SensorSpec& sensor, TemplateObserver& observer,
                                                     DynamicTrialOptions options);

}  // namespace todbench
