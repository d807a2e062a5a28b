// Two TOD curves: different, equivalent, or not decided by these data.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"
#include "tod/tod_curve.h"

namespace todbench {

enum class ComparisonVerdict { equivalent, different, inconclusive };
[[nodiscard]] std::string_view to_string(ComparisonVerdict verdict);

struct ComparisonOptions {
  double margin_percent =
      10;  ///< equivalence margin on the ratio of acuities, chosen beforehand: ratio within [1/(1+m), 1+m]
  FitOptions fit;
};

/// One contrast. Ratio is acuity of A over acuity of B (= S75 of B over S75 of A).
struct ComparisonPoint {
  double set_delta_t_k = 0;
  double delta_t_a_k = 0, delta_t_b_k = 0;
  std::optional<double> ratio;
  Interval ratio_ci95;
  Interval ratio_ci90;
  std::optional<double>
      p_difference;  ///< likelihood-ratio test of a common threshold (chi-square 1), deflated for clustering
  std::optional<double> p_equivalence;  ///< two one-sided tests on the log ratio
  double margin_percent = 0;
  ComparisonVerdict verdict = ComparisonVerdict::inconclusive;
};

struct Comparison {
  std::vector<ComparisonPoint> points;
  ComparisonVerdict verdict =
      ComparisonVerdict::inconclusive;  ///< different if any, else inconclusive if any, else equivalent
};

/// Likelihood-ratio comparison of two data sets at one contrast, with a common or separate slopes.
struct ThresholdTest {
  double lr = 0;  ///< 2 (ll1 - ll0), chi-square with one degree of freedom
  double p_difference = 1;
  double ln_ratio = 0;  ///< ln(threshold A / threshold B)
  double se_ln_ratio = 0;
  double p_equivalence = 1;  ///< TOST, Wald, margin on the ratio
  double ll_separate = 0, ll_common = 0;
};
enum class SlopeModel { shared, separate };
[[nodiscard]] Result<ThresholdTest> test_thresholds(std::span<const Level> a, std::span<const Level> b,
                                                    SlopeModel slopes, double margin_percent,
                                                    const FitOptions& options);

/// Pairs the points of two curves by set contrast (0.5 % tolerance). `invalid_input` when no contrast is in both or the
/// observers differ.
[[nodiscard]] Result<Comparison> compare(const TodCurve& a, const TodCurve& b, const ComparisonOptions& options);

}  // namespace todbench
