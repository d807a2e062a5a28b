// SPDX-License-Identifier: GPL-3.0-or-later
// Comparison of two TOD curves. The verdict is equivalent, different or inconclusive.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Verdict of a comparison. `equivalent`: the 90 % interval of the ratio lies inside the margin. `different`: the
/// interval does not lie inside the margin, and p_difference < 0.05. `inconclusive`: all other cases. The verdict is
/// also inconclusive if a threshold or a side of an interval is missing, or if a value is not fit for a decision. A
/// significant difference that is smaller than the margin has the verdict `equivalent`: with enough trials any small
/// difference is significant, and the margin states which differences matter.
enum class ComparisonVerdict { equivalent, different, inconclusive };
[[nodiscard]] std::string_view to_string(ComparisonVerdict verdict);

/// Options of compare().
struct ComparisonOptions {
  /// Equivalence margin m for the ratio of acuities, chosen beforehand: the ratio must lie within [1/(1+m), 1+m].
  double margin_percent = 10;
  FitOptions fit;  ///< form and lapse with which both curves were fitted
  /// True if curve B was simulated at the contrasts that the camera of curve A measured. The random uncertainty of
  /// these contrasts is then included in the uncertainty of the ratio.
  bool b_shown_contrasts_of_a = false;
};

/// Ratio of the acuities of a camera and its twin at one contrast, from common phases (paired_ratio.h).
struct RatioOfPairs {
  double ratio = 1;  ///< acuity of A divided by that of B
  Interval ci95{}, ci90{};
  double se_ln_ratio = 0;
  double degrees_of_freedom = 1;
  double p_difference = 1, p_equivalence = 1;  ///< as in ComparisonPoint
  ComparisonVerdict verdict = ComparisonVerdict::inconclusive;
  IntervalKind interval = IntervalKind::two_way;  ///< clusters over which the variance is computed
  double twin_share = 0;                          ///< share of the variance that is due to the noise draws of the twin
  int draws = 0;                                  ///< number of noise draws of the twin in each presentation
  /// Number of pairs of answers.
  int answers = 0;
};

/// One contrast. The ratio is acuity of A divided by acuity of B (= S75 of B / S75 of A). Its intervals combine the
/// inflated profile intervals of both thresholds on the log scale, separately for each side (method of variance
/// estimates recovery, Zou and Donner 2008). If a side of the interval of a threshold is open, the corresponding side
/// of the interval of the ratio is missing.
struct ComparisonPoint {
  double set_delta_t_k = 0;
  double delta_t_a_k = 0, delta_t_b_k = 0;
  std::optional<double> ratio{};
  Interval ratio_ci95{};
  Interval ratio_ci90{};
  /// p value of the likelihood-ratio test of a common threshold. The statistic is divided by the variance inflation.
  /// With clusters, the p value is that of Student's t with the degrees of freedom of Welch and Satterthwaite.
  std::optional<double> p_difference{};
  /// p value of two one-sided tests on the log ratio (Schuirmann 1987); standard errors from the two sides of
  /// `ratio_ci90`. The value is below 0.05 if and only if this interval lies inside the margin. Empty if a side of the
  /// interval is missing.
  std::optional<double> p_equivalence{};
  double margin_percent = 0;
  ComparisonVerdict verdict = ComparisonVerdict::inconclusive;
  /// True if the threshold of A or of B is not fit for a decision, or if the functions of A and B differ. All verdicts
  /// of this point, including that of the paired ratio, are then inconclusive.
  bool withheld = false;
  /// Paired ratio. If it is present, it determines the verdict. Empty if the curves do not have the same phases.
  std::optional<RatioOfPairs> paired{};
};

/// Result of compare().
struct Comparison {
  std::vector<ComparisonPoint> points;
  /// `different` if any point is different; otherwise `inconclusive` if any point is inconclusive; otherwise
  /// `equivalent`. Uses the verdicts of paired ratios if they are present.
  ComparisonVerdict verdict = ComparisonVerdict::inconclusive;
  /// Findings that make a threshold of either curve unfit, and findings against the comparison of the two curves.
  /// Empty: not examined (records of earlier versions).
  std::optional<Adequacy> adequacy{};
};

/// Adds a finding about the two curves. If the finding is `unfit`, the verdicts of all points and the overall verdict
/// become inconclusive.
void add_finding(Comparison& comparison, AdequacyFinding finding);

/// Adds a paired ratio to a point and updates the overall verdict. If ComparisonPoint::withheld is true, the verdict of
/// the paired ratio becomes inconclusive.
void add_paired(Comparison& comparison, std::size_t point, const RatioOfPairs& paired);

/// Returns whether the verdict of every point is determined by a paired ratio.
[[nodiscard]] bool decided_by_pairs(const Comparison& comparison);

/// Returns a copy of the comparison. At each point with a paired ratio, the values of the paired ratio replace the
/// unpaired values.
[[nodiscard]] Comparison as_decided(Comparison comparison);

/// Likelihood-ratio comparison of two data sets at one contrast, with a common slope or separate slopes. Trials must be
/// independent.
struct ThresholdTest {
  double lr = 0;  ///< 2 (ll_separate - ll_common), chi-square with one degree of freedom
  double p_difference = 1;
  double ln_ratio = 0;  ///< ln(threshold A / threshold B)
  /// Standard error from the observed information; 0 if the information is singular (a step).
  double se_ln_ratio = 0;
  double p_equivalence = 1;  ///< two one-sided tests (Wald) with the margin of the ratio; 1 without a standard error
  double ll_separate = 0, ll_common = 0;
};
/// Slopes of the two data sets.
enum class SlopeModel { shared, separate };
/// Tests whether two thresholds differ, and whether they are equivalent. A free lapse is fitted separately in each set.
/// Errors: `invalid_input` (wrong levels, a margin that is not positive, a set without a threshold).
[[nodiscard]] Result<ThresholdTest> test_thresholds(std::span<const Level> a, std::span<const Level> b,
                                                    SlopeModel slopes, double margin_percent,
                                                    const FitOptions& options);

/// Compares the points of two curves that have the same set contrast. Two contrasts match if they agree within 0.5 %
/// and no other contrast of either curve is nearer. If the curves are exchanged, the ratios are inverted and the
/// verdicts do not change. A point is inconclusive if the threshold of either curve is unfit. All points are
/// inconclusive if both curves come from the same answers. Errors: `invalid_input` (no common contrast, or different
/// observers).
[[nodiscard]] Result<Comparison> compare(const TodCurve& a, const TodCurve& b, const ComparisonOptions& options);

}  // namespace todbench
