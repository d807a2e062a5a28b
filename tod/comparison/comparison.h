// Two TOD curves: different, equivalent, or not decided by these data.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// equivalent: the 90 % interval of the ratio lies inside the margin. different: it does not, and p_difference < 0.05.
/// inconclusive: neither, or a threshold or a side of an interval is missing, or a number is not fit for a decision.
/// Equivalent wins where a difference is
/// both proven and smaller than the margin: many trials make any small difference significant, and the margin says
/// which ones matter.
enum class ComparisonVerdict { equivalent, different, inconclusive };
[[nodiscard]] std::string_view to_string(ComparisonVerdict verdict);

struct ComparisonOptions {
  /// Equivalence margin on the ratio of acuities, chosen beforehand: ratio within [1/(1+m), 1+m].
  double margin_percent = 10;
  FitOptions fit;  ///< form and lapse with which both curves were fitted
  /// Curve B is of a simulation that was shown the contrasts that the camera of A measured: what is uncertain of them
  /// by their scatter is uncertain of the ratio.
  bool b_shown_contrasts_of_a = false;
};

/// The ratio of a camera to its twin by common phases (paired_ratio.h), at one contrast.
struct RatioOfPairs {
  double ratio = 1;  ///< acuity of A over that of B
  Interval ci95{}, ci90{};
  double se_ln_ratio = 0;
  double degrees_of_freedom = 1;
  double p_difference = 1, p_equivalence = 1;  ///< as of ComparisonPoint
  ComparisonVerdict verdict = ComparisonVerdict::inconclusive;
  IntervalKind interval = IntervalKind::two_way;  ///< of which clusters the variance is
  double twin_share = 0;                          ///< of the variance: that of the twin's draws of noise
  int draws = 0;                                  ///< of noise, that the twin answered in each presentation
  int answers = 0;                                ///< pairs
};

/// One contrast. Ratio is acuity of A over acuity of B (= S75 of B over S75 of A). Its intervals join the inflated
/// profile intervals of both thresholds asymmetrically on the log scale (method of variance estimates recovery, Zou and
/// Donner 2008); where a side of a threshold is open the side of the ratio made of it is missing.
struct ComparisonPoint {
  double set_delta_t_k = 0;
  double delta_t_a_k = 0, delta_t_b_k = 0;
  std::optional<double> ratio{};
  Interval ratio_ci95{};
  Interval ratio_ci90{};
  /// Likelihood-ratio test of a common threshold, its statistic divided by the variance inflation and, with clusters,
  /// referred to Student's t with the degrees of freedom of Welch and Satterthwaite.
  std::optional<double> p_difference{};
  /// Two one-sided tests on the log ratio (Schuirmann 1987) with the spread of either side of `ratio_ci90`: below 0.05
  /// exactly where that interval lies inside the margin. Missing where a side of it is.
  std::optional<double> p_equivalence{};
  double margin_percent = 0;
  ComparisonVerdict verdict = ComparisonVerdict::inconclusive;
  /// Beside the above, where both saw the same phases; it decides. Nothing: they did not.
  std::optional<RatioOfPairs> paired{};
};

struct Comparison {
  std::vector<ComparisonPoint> points;
  /// Different if any, else inconclusive if any, else equivalent; of the paired ratios, where there are any.
  ComparisonVerdict verdict = ComparisonVerdict::inconclusive;
  /// What speaks against the comparison: what makes a threshold of either curve unfit, and what keeps the two from
  /// being compared. Nothing: not examined (records of earlier programs).
  std::optional<Adequacy> adequacy{};
};

/// Adds what is known of the two curves beside their points. A finding that makes them unfit leaves every point and the
/// whole inconclusive.
void add_finding(Comparison& comparison, AdequacyFinding finding);

/// Adds a paired ratio to a point of a comparison, and makes the whole verdict anew. Of a threshold that is not fit for
/// a decision the caller leaves it inconclusive.
void add_paired(Comparison& comparison, std::size_t point, const RatioOfPairs& paired);

/// Whether a paired ratio decides at every contrast.
[[nodiscard]] bool decided_by_pairs(const Comparison& comparison);

/// The comparison as it is decided: with the paired ratio and what belongs to it in place of the unpaired one, where
/// there is one.
[[nodiscard]] Comparison as_decided(Comparison comparison);

/// Likelihood-ratio comparison of two data sets at one contrast, with a common or separate slopes. Trials count as
/// independent.
struct ThresholdTest {
  double lr = 0;  ///< 2 (ll1 - ll0), chi-square with one degree of freedom
  double p_difference = 1;
  double ln_ratio = 0;       ///< ln(threshold A / threshold B)
  double se_ln_ratio = 0;    ///< observed information; 0 where it is singular (a step)
  double p_equivalence = 1;  ///< TOST, Wald, margin on the ratio; 1 without a standard error
  double ll_separate = 0, ll_common = 0;
};
enum class SlopeModel { shared, separate };
/// `invalid_input` for wrong levels, a margin that is not positive, or a set without a threshold. A free lapse is free
/// in each set.
[[nodiscard]] Result<ThresholdTest> test_thresholds(std::span<const Level> a, std::span<const Level> b,
                                                    SlopeModel slopes, double margin_percent,
                                                    const FitOptions& options);

/// Pairs the points of two curves by set contrast: those that are the same one (0.5 %) and the nearest of each other.
/// Exchanged arguments give inverse ratios and the same verdicts. A point whose threshold is unfit in either curve is
/// inconclusive, and so are all where both curves are of the same answers. `invalid_input` when no contrast is in both
/// or the observers differ.
[[nodiscard]] Result<Comparison> compare(const TodCurve& a, const TodCurve& b, const ComparisonOptions& options);

}  // namespace todbench
