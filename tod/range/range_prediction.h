// SPDX-License-Identifier: GPL-3.0-or-later
// Predicts the range at which a target is identified, from a TOD curve.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "acquisition/base/result.h"
#include "tod/psychometric/acuity.h"
#include "tod/psychometric/finding.h"
#include "tod/psychometric/tod_curve.h"
#include "tod/range/transmittance.h"

namespace todbench {

/// One point of a TOD curve for range prediction.
struct TodThreshold {
  double delta_t_k = 0;    ///< magnitude, > 0
  double s75_mrad = 0;     ///< > 0
  Interval s75_ci95_mrad;  ///< a side without a value is open
  /// Magnitude of the set contrast of `delta_t_k`, which identifies this point; 0: not known.
  double set_delta_t_k = 0;
  std::optional<Adequacy> adequacy{};  ///< findings against the threshold; empty: not examined
  /// Lowest and highest S75 over the range of the open parameters of an observer with an eye. Empty: the observer has
  /// no open parameters, or they were not varied.
  std::optional<std::pair<double, double>> s75_spread_mrad{};
};

/// Target and air of a prediction. Signal and criterion are those of Bijl, Hogervorst and Vos (EO-VISTA), 4.2.3.
struct RangeTask {
  double size_m = 0;     ///< square root of the projected area, > 0
  double delta_t_k = 0;  ///< contrast at the target; only the magnitude matters
  double m75 = 5.1;      ///< M = acuity * size / range for 75 % correct answers, > 0; 5.1: small craft in side view
  /// Extinction coefficient, >= 0; apparent contrast = contrast * exp(-extinction * range).
  double extinction_per_km = 0;
  std::optional<Transmittance> air{};  ///< replaces the extinction, which is then 0
};

/// Returns M75 = 0.6 V50. V50 = 8.5 corresponds to M75 = 5.1 for small craft in side view (EO-VISTA, 4.2.3).
[[nodiscard]] double m75_from_v50(double v50);

/// Returns the probability of a correct identification at M / M75. It is the target transfer probability function P =
/// x^E / (1 + x^E), E = 1.51 + 0.24 x, x = V / V50 of the TTP metric, scaled to P(1) = 0.75. It has no guessing term.
[[nodiscard]] double identification_probability(double m_over_m75);

/// Returns 1, 2 or 5 times a power of ten, at most `value`.
[[nodiscard]] double round_step(double value);

/// Probability at one range; empty if the TOD curve does not cover the apparent contrast.
struct RangePoint {
  double range_m = 0;
  double apparent_delta_t_k = 0;
  std::optional<double> probability;
  Interval probability_ci95;
};

/// Result of predict_range().
struct RangePrediction {
  /// Range at which the probability is 75 %; empty if the target line does not intersect the TOD curve.
  std::optional<double> r75_m;
  Interval r75_ci95_m;  ///< 95 % interval from the intervals of the thresholds
  /// Lowest and highest R75, computed with the lowest and with the highest S75 of the spreads. This is not a confidence
  /// interval. Empty: a threshold has no spread, or there is no range for the lowest or for the highest S75. A note
  /// states the reason.
  std::optional<std::pair<double, double>> r75_spread_m{};
  std::string reason;              ///< a sentence with the reason why there is no r75_m; otherwise empty
  std::vector<std::string> notes;  ///< assumptions of this prediction
  /// Findings against the thresholds that determine the range and its interval. Each sentence states the contrast.
  /// Empty: none of these thresholds was examined.
  std::optional<Adequacy> adequacy;
  std::vector<RangePoint> curve;  ///< range increasing
};

/// Thresholds of a curve that have a value. If the curve has both polarities, only thresholds with the target's
/// polarity are included. `notes`: omissions and assumptions.
struct ThresholdSelection {
  std::vector<TodThreshold> thresholds;
  std::vector<std::string> notes;
};
/// Selects the thresholds of a curve for a target.
[[nodiscard]] ThresholdSelection thresholds_of(const TodCurve& curve, double target_delta_t_k);

/// Returns the acuity 1 / S75 in 1/mrad at a contrast. ln acuity is linear in ln contrast between neighbouring
/// thresholds and constant above the highest contrast. Empty below the lowest contrast, because the acuity is not
/// extrapolated towards the noise. Preconditions: thresholds sorted by contrast, not empty.
[[nodiscard]] std::optional<double> interpolated_acuity_per_mrad(std::span<const TodThreshold> sorted,
                                                                 double delta_t_k);

/// Returns the contrast at which the curve is evaluated for a target. If points have a set contrast or an effective
/// contrast equal to `delta_t_k` (same_contrast(), as in a comparison of curves), the result is the effective contrast
/// of the nearest of these points. Otherwise the result is `delta_t_k`. Points without a set contrast are ignored.
[[nodiscard]] double contrast_on_curve(std::span<const TodThreshold> thresholds, double delta_t_k);

/// Solves M(R) = (size / R) acuity(contrast tau(R)) = M75 for the smallest R. tau is exp(-extinction R) or the
/// transmittance of the air. The interval consists of the ranges R for which M75 is within the 95 % interval of M(R).
/// The errors of neighbouring thresholds are assumed to be independent. The contrast of the target is converted by
/// contrast_on_curve(). Errors: `invalid_input` (a parameter out of its range, both extinction and air, no thresholds,
/// thresholds that are not positive and finite, or two thresholds at one contrast).
[[nodiscard]] Result<RangePrediction> predict_range(std::span<const TodThreshold> thresholds, const RangeTask& task);
/// Computes the probability at one range. Beyond the last range of the table of the air, the apparent contrast is 0.
/// Errors: as predict_range().
[[nodiscard]] Result<RangePoint> range_point(std::span<const TodThreshold> thresholds, const RangeTask& task,
                                             double range_m);

}  // namespace todbench
