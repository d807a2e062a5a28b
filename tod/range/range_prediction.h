// From a TOD curve to the range at which a target is identified.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"
#include "tod/psychometric/acuity.h"
#include "tod/psychometric/finding.h"
#include "tod/psychometric/tod_curve.h"
#include "tod/range/transmittance.h"

namespace todbench {

/// One point of a TOD curve as range prediction needs it.
struct TodThreshold {
  double delta_t_k = 0;    ///< magnitude, > 0
  double s75_mrad = 0;     ///< > 0
  Interval s75_ci95_mrad;  ///< a side without a value is open
  /// What the target was told when `delta_t_k` was seen, as a magnitude: the name of this point; 0: not known.
  double set_delta_t_k = 0;
  std::optional<Adequacy> adequacy{};  ///< what speaks against the threshold; nothing: not examined
};

/// What is to be identified, through what air. Signal and criterion as in Bijl, Hogervorst and Vos (EO-VISTA), 4.2.3.
struct RangeTask {
  double size_m = 0;                   ///< square root of the projected area, > 0
  double delta_t_k = 0;                ///< contrast at the target; only the magnitude counts
  double m75 = 5.1;                    ///< M at which 75 % are correct, > 0; 5.1: small craft, side view
  double extinction_per_km = 0;        ///< apparent contrast = contrast times exp(-extinction range), >= 0
  std::optional<Transmittance> air{};  ///< in place of the extinction, which then is 0
};

/// M75 = 0.6 V50: V50 = 8.5 and M75 = 5.1 belong together for small craft in side view (EO-VISTA, 4.2.3).
[[nodiscard]] double m75_from_v50(double v50);

/// Probability of a correct identification at M / M75: the target transfer probability function
/// P = x^E / (1 + x^E), E = 1.51 + 0.24 x, x = V / V50, scaled so that P(1) = 0.75. No part for guessing.
[[nodiscard]] double identification_probability(double m_over_m75);

/// Probability at one range; nothing where the TOD curve says nothing about the apparent contrast.
struct RangePoint {
  double range_m = 0;
  double apparent_delta_t_k = 0;
  std::optional<double> probability;
  Interval probability_ci95;
};

struct RangePrediction {
  std::optional<double> r75_m;     ///< nothing when the target line does not meet the TOD curve
  Interval r75_ci95_m;             ///< from the intervals of the thresholds
  std::string reason;              ///< why there is no r75_m, in a sentence; else empty
  std::vector<std::string> notes;  ///< assumptions that this prediction needed
  /// Findings of the thresholds that the range and its interval rest on, each with its contrast in the sentence;
  /// nothing where none of these thresholds was examined.
  std::optional<Adequacy> adequacy;
  std::vector<RangePoint> curve;  ///< range increasing
};

/// The thresholds of a curve that have a value, of the target's polarity where the curve has both. `notes` says what
/// was left out or assumed.
struct ThresholdSelection {
  std::vector<TodThreshold> thresholds;
  std::vector<std::string> notes;
};
[[nodiscard]] ThresholdSelection thresholds_of(const TodCurve& curve, double target_delta_t_k);

/// Acuity 1 / S75 in 1/mrad at a contrast: ln acuity is linear in ln contrast between neighbouring thresholds, constant
/// above the highest contrast, and not known below the lowest: nothing is extrapolated towards noise.
/// Preconditions: thresholds sorted by contrast, not empty.
[[nodiscard]] std::optional<double> interpolated_acuity_per_mrad(std::span<const TodThreshold> sorted,
                                                                 double delta_t_k);

/// The contrast at which the curve answers for a target. A target that has the set contrast of a point, or that which
/// the camera saw of it, has that point (same_contrast(), as in a comparison of curves), the nearest of several; any
/// other is what it is. Points without a set contrast name nothing.
[[nodiscard]] double contrast_on_curve(std::span<const TodThreshold> thresholds, double delta_t_k);

/// Solves M(R) = (size / R) acuity(contrast tau(R)) = M75 for the smallest R; tau is exp(-extinction R) or that of the
/// air. The interval holds the R at which M75 is within the 95 % interval of M(R), the errors of neighbouring
/// thresholds taken as independent. The target's contrast is that of contrast_on_curve(). `invalid_input`: a parameter
/// out of its range, an extinction beside the air, no thresholds, thresholds that are not positive and finite, or two
/// at one contrast.
[[nodiscard]] Result<RangePrediction> predict_range(std::span<const TodThreshold> thresholds, const RangeTask& task);
/// The same at one range; contrast 0 beyond the end of the air's table. Errors: as predict_range().
[[nodiscard]] Result<RangePoint> range_point(std::span<const TodThreshold> thresholds, const RangeTask& task,
                                             double range_m);

}  // namespace todbench
