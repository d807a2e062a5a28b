// SPDX-License-Identifier: GPL-3.0-or-later
// Graded answers: the same function, with intervals from two kinds of clusters.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/tod/psychometric/graded_support.h"
#include "tod/psychometric/tod_curve.h"
#include "tod/psychometric/twin_shape.h"

namespace todbench {
namespace {

using testing::graded_answers_of;
using testing::GradedBench;
using testing::table_of;
using testing::true_proportion;

struct Record {
  double bias = 0, scatter = 0, stated = 0, coverage = 0;
};

template <typename Fit>
Record record_of(int runs, double truth, const Fit& fit) {
  double sum = 0, squares = 0;
  Record record;
  for (int run = 1; run <= runs; ++run) {
    const PsychometricFit found = fit(static_cast<std::uint64_t>(run));
    EXPECT_TRUE(found.usable()) << "run " << run << ": " << to_string(found.verdict);
    if (!found.usable()) continue;
    const double error = std::log(*found.threshold / truth);
    sum += error;
    squares += error * error;
    record.stated += *found.se_ln_threshold * std::sqrt(found.variance_inflation) / runs;
    record.coverage += *found.ci95.low <= truth && truth <= *found.ci95.high ? 1.0 / runs : 0;
  }
  record.bias = sum / runs;
  record.scatter = std::sqrt((squares - sum * sum / runs) / (runs - 1));
  return record;
}

constexpr int runs = 100;
/// Three standard errors of a share of 0.95.
const double share_tolerance = 3 * std::sqrt(0.95 * 0.05 / runs);

void expect_honest(const Record& record, const char* what) {
  // A scatter of n runs has a relative error of 1 / sqrt(2 n).
  EXPECT_NEAR(record.stated / record.scatter, 1, 3.5 / std::sqrt(2.0 * runs) + 0.03) << what;
  EXPECT_GT(record.coverage, 0.95 - share_tolerance) << what;
  EXPECT_LT(std::abs(record.bias), 3.5 * record.scatter / std::sqrt(runs) + 0.0005) << what;
}

TEST(GradedFit, IsNarrowerThanThatOfRightAndWrongAnswers) {
  const GradedBench bench;
  const auto answers = graded_answers_of(bench, 1);
  const RandomStream lots(1, "lots");
  std::vector<Level> levels;
  for (std::size_t i = 0; i < answers.size(); ++i)
    levels.push_back({answers[i].size, lots.uniform(i) < answers[i].probability_correct ? 1.0 : 0.0, 1, -1});

  const auto graded = fit_graded(answers, {}), binary = fit_psychometric(levels, {});

  ASSERT_TRUE(graded && binary);
  EXPECT_EQ(graded->interval, IntervalKind::set_ups);
  EXPECT_EQ(binary->interval, IntervalKind::independent);
  EXPECT_LT(graded->variance_inflation, 0.5);
  EXPECT_LT(*graded->dispersion, 0.5);
  EXPECT_LT(std::log(*graded->ci95.high / *graded->ci95.low), 0.75 * std::log(*binary->ci95.high / *binary->ci95.low));
}

TEST(GradedFit, OfRightAndWrongAnswersHasTheirMaximum) {
  std::vector<GradedAnswer> answers = graded_answers_of({}, 1);
  const RandomStream lots(1, "lots");
  std::vector<Level> levels;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    answers[i].probability_correct = lots.uniform(i) < answers[i].probability_correct ? 1 : 0;
    levels.push_back({answers[i].size, answers[i].probability_correct, 1, -1});
  }

  const auto graded = fit_graded(answers, {}), binary = fit_psychometric(levels, {});

  ASSERT_TRUE(graded && binary);
  EXPECT_EQ(graded->threshold, binary->threshold);
  EXPECT_EQ(graded->slope, binary->slope);
  EXPECT_TRUE(graded->dispersion);
}

TEST(GradedFit, RefusesWhatIsNoProbability) {
  for (const double wrong : {-0.1, 1.1, std::nan("")}) {
    const std::vector<GradedAnswer> answers{{.size = 1, .probability_correct = wrong}};
    EXPECT_FALSE(fit_graded(answers, {})) << wrong;
  }
  EXPECT_EQ(fit_graded({}, {})->verdict, FitVerdict::no_data);
  const std::vector<Level> fraction{{1, 0.5, 1, -1}};
  EXPECT_FALSE(fit_psychometric(fraction, {}));
}

TEST(GradedFit, OfAnswersThatAreAllCertainHasAVerdictAndNoNumber) {
  std::vector<GradedAnswer> answers = graded_answers_of({}, 1);
  for (GradedAnswer& answer : answers) answer.probability_correct = 1;
  EXPECT_EQ(fit_graded(answers, {})->verdict, FitVerdict::below_range);
  for (GradedAnswer& answer : answers) answer.probability_correct = 0.25;
  EXPECT_EQ(fit_graded(answers, {})->verdict, FitVerdict::above_range);
}

PsychometricFit by_twin(const std::vector<GradedAnswer>& answers, const ProportionTable& table) {
  return fit_twin_shape(answers, fit_graded(answers, {}).value(), table, {}).value();
}

TEST(TwinShape, HoldsTheThresholdWhateverAnswersHaveInCommon) {
  for (const GradedBench& bench : {GradedBench{}, GradedBench{.presentation_sd = 0.1}, GradedBench{.place_sd = 0.1},
                                   GradedBench{.presentation_sd = 0.06, .place_sd = 0.06}}) {
    const Record record = record_of(runs, 2, [&](std::uint64_t seed) {
      return by_twin(graded_answers_of(bench, seed), table_of({}, 0.0005, seed));
    });

    expect_honest(record, bench.presentation_sd > 0 ? "presentations" : bench.place_sd > 0 ? "places" : "neither");
  }
}

TEST(TwinShape, IsItsTableAndRises) {
  const ProportionTable table = table_of({}, 0.002, 1);
  const auto shape = TwinShape::of(table);

  ASSERT_TRUE(shape) << shape.error().message;
  EXPECT_NEAR(std::exp(shape->ln_threshold()), 2, 0.01);
  double before = 0.2;
  for (double x = std::log(0.5); x < std::log(9.0); x += 0.01) {
    const auto at = shape->at(x);
    EXPECT_GE(at.proportion, before);
    EXPECT_NEAR(at.proportion, true_proportion(std::exp(x), 2, 1), 0.01) << std::exp(x);
    const double h = 1e-6;
    EXPECT_NEAR(at.derivative, (shape->at(x + h).proportion - shape->at(x - h).proportion) / (2 * h), 2e-4);
    before = at.proportion;
  }
}

TEST(TwinShape, HoldsTheThresholdWhereAWeibullFunctionMissesIt) {
  // A camera that is 5 % worse than its twin.
  const GradedBench bench{.threshold = 2.1};
  const auto weibull =
      record_of(runs, 2.1, [&](std::uint64_t seed) { return fit_graded(graded_answers_of(bench, seed), {}).value(); });
  const auto twin = record_of(runs, 2.1, [&](std::uint64_t seed) {
    return by_twin(graded_answers_of(bench, seed), table_of({}, 0.003, seed));
  });

  EXPECT_GT(std::abs(weibull.bias), 5 * weibull.scatter / std::sqrt(runs)) << "the true function is no Weibull";
  EXPECT_LT(std::abs(twin.bias), 0.003);
  expect_honest(twin, "twin");
}

TEST(TwinShape, TakesAnotherSlopeOnlyWhereTheAnswersAskForIt) {
  int taken = 0, needed = 0;
  double bias = 0;
  for (int run = 1; run <= runs; ++run) {
    const auto seed = static_cast<std::uint64_t>(run);
    const auto alike = by_twin(graded_answers_of({}, seed), table_of({}, 0.001, seed));
    const auto flatter = by_twin(graded_answers_of({.slope_ratio = 0.7}, seed), table_of({}, 0.001, seed));
    taken += alike.twin_shape->slope_fitted ? 1 : 0;
    needed += flatter.twin_shape->slope_fitted ? 1 : 0;
    bias += std::log(*flatter.threshold / 2) / runs;
  }
  // 1 % by chance.
  EXPECT_LE(taken, 0.01 * runs + 3.5 * std::sqrt(0.01 * runs));
  EXPECT_GT(needed, 0.9 * runs);
  EXPECT_LT(std::abs(bias), 0.003);
}

TEST(TwinShape, SaysWhatTheErrorsOfItsTableAdd) {
  const auto answers = graded_answers_of({}, 1);
  const double exact = by_twin(answers, table_of({}, 0.0001, 1)).twin_shape->shape_se_ln_threshold;
  const double rough = by_twin(answers, table_of({}, 0.01, 1)).twin_shape->shape_se_ln_threshold;

  EXPECT_LT(exact, 2e-4);
  EXPECT_GT(rough, 10 * exact);
  double squares = 0;
  constexpr int tables = 60;
  const double centre = std::log(*by_twin(answers, table_of({}, 0, 1)).threshold);
  for (int k = 1; k <= tables; ++k)
    squares +=
        std::pow(std::log(*by_twin(answers, table_of({}, 0.01, static_cast<std::uint64_t>(k))).threshold) - centre, 2) /
        tables;
  EXPECT_NEAR(std::sqrt(squares) / rough, 1, 0.4);
}

TEST(TwinShape, RefusesTablesThatSayNothing) {
  const ProportionTable good = table_of({}, 0.001, 1);
  const auto with = [&](auto change) {
    ProportionTable table = good;
    change(table);
    return TwinShape::of(table);
  };
  EXPECT_TRUE(with([](ProportionTable&) {}));
  EXPECT_FALSE(with([](ProportionTable& t) { t = {}; }));
  EXPECT_FALSE(with([](ProportionTable& t) { t.size_mrad[3] = t.size_mrad[2]; }));
  EXPECT_FALSE(with([](ProportionTable& t) { t.size_mrad[0] = -1; }));
  EXPECT_FALSE(with([](ProportionTable& t) { t.proportion_correct[1] = 1.5; }));
  EXPECT_FALSE(with([](ProportionTable& t) { t.standard_error[1] = INFINITY; }));
  EXPECT_FALSE(with([](ProportionTable& t) { t.standard_error.pop_back(); }));
  EXPECT_FALSE(with([](ProportionTable& t) { std::ranges::fill(t.proportion_correct, 0.5); }));
  EXPECT_FALSE(with([](ProportionTable& t) { std::ranges::fill(t.standard_error, 0.5); }));
}

/// Whole presentations of right and wrong answers, some of them lapses.
std::vector<GradedAnswer> right_and_wrong(const GradedBench& bench, double lapse, std::uint64_t seed) {
  std::vector<GradedAnswer> answers = graded_answers_of(bench, seed);
  const RandomStream lots(seed, "lots");
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const double mu = true_proportion(answers[i].size, bench.threshold, bench.slope_ratio);
    answers[i].probability_correct = lots.uniform(i) < 0.25 + (0.75 - lapse) * (mu - 0.25) / 0.75 ? 1 : 0;
  }
  return answers;
}

/// Where answers with lapses are right in 75 %, by bisection.
double size_with_lapse(double threshold, double lapse) {
  double low = threshold / 2, high = threshold * 2;
  for (int step = 0; step < 60; ++step) {
    const double middle = std::sqrt(low * high);
    const double p = 0.25 + (0.75 - lapse) * (true_proportion(middle, threshold, 1) - 0.25) / 0.75;
    (p < 0.75 ? low : high) = middle;
  }
  return low;
}

Result<PsychometricFit> fitted(const std::vector<GradedAnswer>& answers, const ProportionTable& table,
                               const FitOptions& options) {
  const auto weibull = fit_graded(answers, options);
  if (!weibull) return weibull;
  return fit_twin_shape(answers, *weibull, table, options);
}

TEST(TwinShape, FindsTheLapseAndTheThresholdOfExactProportions) {
  constexpr double lapse = 0.04;
  std::vector<GradedAnswer> answers = graded_answers_of({}, 1);
  for (GradedAnswer& answer : answers)
    answer.probability_correct = 0.25 + (0.75 - lapse) * (true_proportion(answer.size, 2, 1) - 0.25) / 0.75;
  const ProportionTable table = table_of({}, 0, 1);

  const auto fixed = fitted(answers, table, {.fixed_lapse = lapse});
  const auto free = fitted(answers, table, {.fixed_lapse = std::nullopt});
  const auto none = fitted(answers, table, {.fixed_lapse = 0.0});

  ASSERT_TRUE(fixed && free && none);
  // The table is smoothed: 0.1 % of size, 0.001 of a proportion.
  EXPECT_NEAR(std::log(*fixed->threshold / size_with_lapse(2, lapse)), 0, 1e-3);
  EXPECT_EQ(fixed->lapse, lapse);
  EXPECT_NEAR(std::log(*free->threshold / size_with_lapse(2, lapse)), 0, 1e-3);
  EXPECT_NEAR(free->lapse, lapse, 1e-3);
  EXPECT_GT(std::abs(std::log(*none->threshold / size_with_lapse(2, lapse))), 0.005);
  const auto shape = TwinShape::of(table);
  EXPECT_NEAR(twin_proportion(*shape, *free->twin_shape, free->lapse, std::log(*free->threshold)), 0.75, 1e-6);
  EXPECT_NEAR(twin_proportion(*shape, *free->twin_shape, free->lapse, std::log(4.4)),
              0.25 + (0.75 - lapse) * (true_proportion(4.4, 2, 1) - 0.25) / 0.75, 2e-3);
}

TEST(TwinShape, HoldsTheThresholdOfRightAndWrongAnswersWithAndWithoutLapses) {
  for (const auto& [lapse, options] :
       {std::pair(0.0, FitOptions{}), std::pair(0.0, FitOptions{.fixed_lapse = std::nullopt}),
        std::pair(0.04, FitOptions{.fixed_lapse = 0.04}), std::pair(0.04, FitOptions{.fixed_lapse = std::nullopt})}) {
    const Record record = record_of(runs, size_with_lapse(2, lapse), [&](std::uint64_t seed) {
      auto fit = fitted(right_and_wrong({}, lapse, seed), table_of({}, 0.003, seed), options).value();
      EXPECT_EQ(fit.interval, IntervalKind::two_way);
      EXPECT_GE(fit.variance_inflation, 1);
      EXPECT_TRUE(fit.deviance);
      EXPECT_FALSE(fit.dispersion);
      return fit;
    });
    EXPECT_GT(record.coverage, 0.95 - share_tolerance) << lapse;
    EXPECT_LT(std::abs(record.bias), 3.5 * record.scatter / std::sqrt(runs) + 0.001) << lapse;
    // Not below chance, so a little long: the largest of four variances.
    EXPECT_NEAR(record.stated / record.scatter, 1.05, 3.5 / std::sqrt(2.0 * runs) + 0.05) << lapse;
  }
}

TEST(TwinShape, ALapseThatTheFitDoesNotAllowForIsFound) {
  int warned = 0, found = 0;
  for (int run = 1; run <= runs; ++run) {
    const auto seed = static_cast<std::uint64_t>(run);
    const auto gain = [&](const std::vector<GradedAnswer>& answers) {
      const auto fit = fitted(answers, table_of({}, 0.001, seed), {});
      const auto free = twin_fit_with_free_lapse(answers, *fit, PsychometricForm::size);
      return twin_lapse_gain(*fit, *free);
    };
    warned += gain(right_and_wrong({}, 0, seed)) > boundary_drop ? 1 : 0;
    found += gain(right_and_wrong({}, 0.05, seed)) > boundary_drop ? 1 : 0;
  }
  EXPECT_LE(warned, 0.05 * runs + 3.5 * std::sqrt(0.05 * 0.95 * runs));
  EXPECT_GT(found, 0.5 * runs);
  EXPECT_FALSE(twin_fit_with_free_lapse({}, PsychometricFit{}, PsychometricForm::size));
}

TEST(TwinShape, LeavesAnIrregularFitAsItIs) {
  std::vector<GradedAnswer> answers = graded_answers_of({}, 1);
  const ProportionTable table = table_of({}, 0.001, 1);
  const auto regular = fit_graded(answers, {}).value();
  for (const double wrong : {-0.01, 0.2, std::nan("")})
    EXPECT_FALSE(fit_twin_shape(answers, regular, table, {.fixed_lapse = wrong})) << wrong;
  for (GradedAnswer& answer : answers) answer.probability_correct = 1;
  const auto fit = by_twin(answers, table);
  EXPECT_EQ(fit.verdict, FitVerdict::below_range);
  EXPECT_FALSE(fit.twin_shape);
}

}  // namespace
}  // namespace todbench
