// SPDX-License-Identifier: GPL-3.0-or-later
// Short form of paired_comparison_study, and what must not be shared.
#include "tests/bench/studies/paired_summary.h"

namespace todbench::testing {
namespace {

const GradedDesign& short_pairs() {
  static const GradedDesign design{.name = "short pairs", .phases = 3, .frames = {2}, .delta_t_k = {1.93}};
  return design;
}

TEST(PairedComparison, IsNarrowerThanTwoThresholdsAndHoldsTheTruth) {
  std::vector<GradedResult> rows;
  DesignParts parts(short_pairs());
  for (const std::uint64_t seed : {911, 912})
    for (const GradedResult& row : results_of(parts, seed, true)) rows.push_back(row);

  const PairedSummary s = paired_summary(rows, "short pairs", 1.93, 1, 3);

  ASSERT_EQ(s.runs, 2);
  // The demonstration has 0.28 %, a quarter of its trials and half the frames 0.7 %; two times seven degrees of freedom
  // tell that to a fifth.
  EXPECT_LT(s.stated_percent, 1.3);
  EXPECT_LT(s.stated_percent, 0.5 * s.binary_percent) << "4.2 %";
  EXPECT_LT(std::abs(s.bias_percent), 4 * s.stated_percent / std::sqrt(2.0));
  EXPECT_LT(s.twin_share, 0.3);
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  double aa = 0, bb = 0, ab = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    aa += a[i] * a[i];
    bb += b[i] * b[i];
    ab += a[i] * b[i];
  }
  return ab / std::sqrt(aa * bb);
}

/// Of the plan's seed and of another: the twin knows the phases of the camera, and nothing of its noise.
TEST(PairedComparison, SharesNoNoiseWithASimulatedCameraOfTheSameSeed) {
  GradedDesign design = short_pairs();
  design.frames = {1};
  design.phases = 2;
  design.delta_t_k = {0.23};
  const Plan plan = plan_of(design, 913);
  const ExperimentInputs inputs = inputs_of(plan, design.camera);
  DesignParts parts(design);
  const std::vector<Trial> trials = trials_of(plan, inputs, parts);
  ASSERT_EQ(trials.size(), 320u);
  TemplateObserver observer(inputs.observer, triangle_alternatives());
  const auto answers_of = [&](std::uint64_t seed, int draws) {
    PairedTwinOptions options = paired_options(inputs, {}, seed, {});
    options.draws = draws;
    const auto found = twin_answers(inputs.sensor, inputs.effects, observer, trials, options);
    EXPECT_TRUE(found);
    std::vector<double> out;
    for (const TwinAnswer& answer : *found) out.push_back(answer.probability_correct);
    return out;
  };
  // The mean of many draws takes out size and phase.
  const std::vector<double> mean = answers_of(77, 16);
  std::vector<double> camera, own = answers_of(plan.seed, 2), other = answers_of(78, 2);
  for (std::size_t i = 0; i < trials.size(); ++i) {
    camera.push_back(*trials[i].probability_correct - mean[i]);
    own[i] -= mean[i];
    other[i] -= mean[i];
  }
  // All of them share the noise of that mean. Four standard errors of a difference of correlations of 320 pairs.
  EXPECT_NEAR(correlation(camera, own), correlation(camera, other), 4 * std::sqrt(2.0 / 320));
  EXPECT_EQ(answers_of(78, 2), answers_of(78, 2)) << "a function of the seed";
}

TEST(PairedComparison, RefusesWhatCannotBeShown) {
  const Plan plan = plan_of(short_pairs(), 1);
  const ExperimentInputs inputs = inputs_of(plan, {});
  TemplateObserver observer(inputs.observer, triangle_alternatives());
  std::vector<Trial> trials(1);
  trials[0].size_mrad = 2;
  PairedTwinOptions options = paired_options(inputs, {}, 1, {});
  const auto code = [&] { return twin_answers(inputs.sensor, inputs.effects, observer, trials, options).error().code; };
  EXPECT_EQ(code(), ErrorCode::invalid_input) << "no contrast";
  trials[0].delta_t_k = 1;
  options.draws = 1;
  EXPECT_EQ(code(), ErrorCode::invalid_input);
  options.draws = 2;
  std::stop_source stop;
  stop.request_stop();
  options.stop = stop.get_token();
  EXPECT_EQ(code(), ErrorCode::interrupted);
}

}  // namespace
}  // namespace todbench::testing
