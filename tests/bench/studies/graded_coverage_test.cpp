// SPDX-License-Identifier: GPL-3.0-or-later
// Short form of graded_coverage_study.
#include "tests/bench/studies/graded_runs.h"
#include "tests/support/temporary_folder.h"

namespace todbench::testing {
namespace {

TEST(GradedCoverage, OfGradedAnswersIsNarrowerAndHoldsTheTruth) {
  const GradedDesign design{.name = "short", .phases = 3, .frames = {2}, .delta_t_k = {1.93}};
  // As of graded_coverage_study: three times 8000 draws at the level reference, standard error 0.1 %.
  const std::map<double, double> truth = true_s75_mrad(design, {1.93}, 1);
  std::vector<GradedResult> rows;
  DesignParts parts(design);
  for (std::uint64_t seed = 901; seed <= 903; ++seed) {
    for (const GradedResult& row : results_of(parts, seed))
      if (row.delta_t_k == 1.93) rows.push_back(row);
  }

  const auto graded = summary_of(rows, "short", 1.93, "graded twin-shape", truth.at(1.93));
  const auto binary = summary_of(rows, "short", 1.93, "binary weibull", truth.at(1.93));

  ASSERT_EQ(graded.runs, 3);
  EXPECT_GE(graded.coverage, 0.6) << "two of three: fewer has a probability of 0.7 % at 95 %";
  EXPECT_LT(graded.half_width_percent, 0.8 * binary.half_width_percent);
  EXPECT_LT(std::abs(graded.bias_percent), 3 * graded.stated_percent / std::sqrt(3.0) + 0.5);
}

TEST(GradedCoverage, OfAStudyGoesOnWhereItWas) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "runs.csv").string();
  const GradedResult row{"a design", 7, 0.23, "graded twin-shape", 3.25, 3.125, 3.5, 1.5, 24.5, 1};
  GradedRecord(file).append({row});

  const GradedRecord record(file);

  ASSERT_EQ(record.rows().size(), 1u);
  EXPECT_TRUE(record.has("a design", 7));
  EXPECT_FALSE(record.has("a design", 8));
  EXPECT_EQ(record.rows()[0].estimator, row.estimator);
  EXPECT_EQ(record.rows()[0].high_mrad, row.high_mrad);
  EXPECT_EQ(record.rows()[0].slope_fitted, 1);
}

}  // namespace
}  // namespace todbench::testing
