// SPDX-License-Identifier: GPL-3.0-or-later
// What came of pairs of camera and twin.
#pragma once

#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "tests/bench/studies/graded_runs.h"

namespace todbench::testing {

/// At one contrast of one design. Shares are of the pairs.
struct PairedSummary {
  int runs = 0;
  double bias_percent = 0, scatter_percent = 0, stated_percent = 0, twin_share = 0, coverage = 0;
  double equivalent = 0;            ///< of ratios that are as they are
  double equivalent_at_margin = 0;  ///< of the same moved to the margin, to one side
  double different = 0;             ///< p below 0.05, of ratios with the true one taken out
  double unpaired_percent = 0;      ///< stated standard error of the ratio of two such graded runs
  double binary_percent = 0;        ///< of two runs with one bit an answer
};

inline PairedSummary paired_summary(const std::vector<GradedResult>& rows, const std::string& design, double delta_t_k,
                                    double true_ratio, double margin_percent) {
  PairedSummary out;
  const double margin = std::log1p(margin_percent / 100);
  double squares = 0;
  for (const GradedResult& row : rows) {
    if (row.design != design || row.delta_t_k != delta_t_k) continue;
    if (row.estimator == "graded twin-shape") out.unpaired_percent += std::sqrt(2.0) * row.se_percent;
    if (row.estimator == "binary weibull") out.binary_percent += std::sqrt(2.0) * row.se_percent;
    if (row.estimator != "paired") continue;
    ++out.runs;
    const double se = row.se_percent / 100, ratio = std::log(row.s75_mrad), error = ratio - std::log(true_ratio);
    const boost::math::students_t t(row.clusters - 1);
    const double half_90 = boost::math::quantile(t, 0.95) * se, half_95 = boost::math::quantile(t, 0.975) * se;
    out.bias_percent += 100 * error;
    squares += 1e4 * error * error;
    out.stated_percent += row.se_percent;
    out.twin_share += row.slope_fitted;
    out.coverage += std::abs(error) <= half_95 ? 1 : 0;
    out.different += std::abs(error) > half_95 ? 1 : 0;
    out.equivalent += std::abs(ratio) + half_90 <= margin ? 1 : 0;
    out.equivalent_at_margin += std::abs(error + margin) + half_90 <= margin ? 1 : 0;
  }
  if (out.runs < 2) return out;
  const double n = out.runs;
  out.bias_percent /= n;
  out.scatter_percent = std::sqrt((squares - n * out.bias_percent * out.bias_percent) / (n - 1));
  for (double* value : {&out.stated_percent, &out.twin_share, &out.coverage, &out.different, &out.equivalent,
                        &out.equivalent_at_margin, &out.unpaired_percent, &out.binary_percent})
    *value /= n;
  return out;
}

}  // namespace todbench::testing
