// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/psychometric/clustered_variance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "acquisition/base/rng.h"

namespace todbench {
namespace {

/// A table with one answer of every presentation at every place, and a mean as the only parameter.
std::vector<AnswerScore> table_of(int presentations, int places, const std::function<double(int, int)>& value) {
  std::vector<AnswerScore> answers;
  double mean = 0;
  for (int i = 0; i < presentations; ++i) {
    for (int j = 0; j < places; ++j) {
      answers.push_back({.direction = {1, 0, 0}, .residual = value(i, j), .presentation = i, .place = j});
      mean += value(i, j) / (presentations * places);
    }
  }
  for (AnswerScore& answer : answers) answer.residual -= mean;
  return answers;
}

double squares(double x) {
  return x * x;
}

TEST(ClusteredVariance, OfAFullTableInOneSetUpIsThatOfItsMargins) {
  constexpr int presentations = 7, places = 5, n = presentations * places;
  const RandomStream stream(3, "table");
  const auto answers = table_of(presentations, places, [&](int i, int j) {
    return static_cast<double>(stream.normal(static_cast<std::uint64_t>(places * i + j)) +
                               2 * stream.normal(static_cast<std::uint64_t>(1000 + i)) +
                               2 * stream.normal(static_cast<std::uint64_t>(2000 + j)));
  });

  const ClusteredVariance found = clustered_variance(answers, 1, 0);

  std::vector<double> rows(presentations), columns(places);
  double cells = 0;
  for (const AnswerScore& answer : answers) {
    rows[static_cast<std::size_t>(answer.presentation)] += answer.residual;
    columns[static_cast<std::size_t>(answer.place)] += answer.residual;
    cells += squares(answer.residual);
  }
  double by_row = 0, by_column = 0;
  for (const double row : rows) by_row += squares(row);
  for (const double column : columns) by_column += squares(column);
  // Every cluster of an even table has the leverage of its share.
  const double expected =
      (by_row / (1 - 1.0 / presentations) + by_column / (1 - 1.0 / places) - cells / (1 - 1.0 / n)) / (n * n);
  EXPECT_EQ(found.kind, IntervalKind::two_way);
  EXPECT_NEAR(found.variance, expected, 1e-12 * expected);
  EXPECT_NEAR(found.independent, 1.0 / n, 1e-15);
  EXPECT_NEAR(found.dispersion, cells / (n - 1), 1e-12);
  EXPECT_NEAR(found.degrees_of_freedom, places - 1, 1e-9);
}

TEST(ClusteredVariance, IsNotBelowThatOfPlacesWherePresentationsCancel) {
  // Phases that are spread evenly add up to nothing over the presentations of a place.
  const auto answers = table_of(4, 3, [](int i, int j) { return (i % 2 == 0 ? 1 : -1) * (j == 1 ? 2 : -0.5); });

  const ClusteredVariance found = clustered_variance(answers, 1, 0);

  EXPECT_GT(found.variance, 0);
  EXPECT_LT(found.variance, 1);
  EXPECT_NEAR(found.degrees_of_freedom, 2, 1e-9);
}

/// Eight set-ups of `presentations` at `places`; what a set-up shares, what each answer has alone, and by how much the
/// presentations of a place cancel.
struct Scatter {
  double set_up = 0, single = 1, cancel = 0;
};

TEST(ClusteredVariance, OfSetUpsHoldsThatOfTheMeanWhateverTheyHaveInCommon) {
  constexpr int tables = 800, set_ups = 8, presentations = 4, places = 6, n = set_ups * presentations * places;
  for (const Scatter c :
       {Scatter{}, Scatter{.set_up = 0.5}, Scatter{.cancel = 2}, Scatter{.single = 0.6, .cancel = 2}}) {
    double mean_variance = 0, actual = 0, by_chance = 0;
    for (int t = 0; t < tables; ++t) {
      const RandomStream stream(static_cast<std::uint64_t>(t), "set-ups");
      std::vector<AnswerScore> answers;
      double mean = 0;
      for (int k = 0; k < n; ++k) {
        const int set_up = k / (presentations * places), i = k / places, j = k % places;
        const auto normal = [&](int number, int index) {
          return static_cast<double>(
              stream.sub(static_cast<std::uint64_t>(number)).normal(static_cast<std::uint64_t>(index)));
        };
        const double value = c.set_up * normal(0, set_up) + c.single * normal(1, k) +
                             c.cancel * (i % 2 == 0 ? 1 : -1) * normal(2, set_up * places + j);
        answers.push_back({.direction = {1, 0, 0},
                           .residual = value,
                           .presentation = i,
                           .place = set_up * places + j,
                           .set_up = set_up});
        mean += value / n;
      }
      for (AnswerScore& answer : answers) answer.residual -= mean;
      const ClusteredVariance found = clustered_variance(answers, 1, 0);
      EXPECT_EQ(found.kind, IntervalKind::set_ups);
      EXPECT_NEAR(found.degrees_of_freedom, set_ups - 1, 1e-9);
      actual += squares(mean) / tables;
      mean_variance += found.variance / tables;
      by_chance += found.dispersion * found.independent / tables;
    }
    // Variances of 800 means, and means of 800 variances of 7 degrees of freedom.
    EXPECT_NEAR(mean_variance / actual, 1, 4 * std::sqrt(2.0 / tables + 2.0 / 7 / tables))
        << c.set_up << " " << c.cancel;
    if (c.cancel > 0) {
      EXPECT_LT(mean_variance, 0.5 * by_chance) << "below that of independent answers";
    }
  }
}

/// Eight set-ups put triangles before the same detectors, whose pattern favours or hinders all that is shown there.
TEST(ClusteredVariance, OfSetUpsHasWhatTheyShareAtOnePlaceInThePicture) {
  constexpr int tables = 800, set_ups = 8, presentations = 4, places = 20, n = set_ups * presentations * places;
  for (const double pattern : {0.0, 0.25}) {
    double mean_variance = 0, actual = 0, apart = 0;
    for (int t = 0; t < tables; ++t) {
      const RandomStream stream(static_cast<std::uint64_t>(t), "detectors");
      std::vector<AnswerScore> answers;
      double mean = 0;
      for (int k = 0; k < n; ++k) {
        const int set_up = k / (presentations * places), place = k % places;
        const double value = static_cast<double>(stream.sub(0).normal(static_cast<std::uint64_t>(k))) +
                             pattern * static_cast<double>(stream.sub(1).normal(static_cast<std::uint64_t>(place)));
        answers.push_back(
            {.direction = {1}, .residual = value, .presentation = k / places, .place = place, .set_up = set_up});
        mean += value / n;
      }
      for (AnswerScore& answer : answers) answer.residual -= mean;
      mean_variance += clustered_variance(answers, 1, 0).variance / tables;
      actual += squares(mean) / tables;
      // The same triangles, each before detectors of its own.
      for (AnswerScore& answer : answers) answer.place += places * answer.set_up;
      apart += clustered_variance(answers, 1, 0).variance / tables;
    }
    // Never shorter: without a pattern by what chance shows of one, a tenth of the variance.
    EXPECT_GT(mean_variance / actual, 1 - 4 * std::sqrt(2.0 / tables)) << pattern;
    EXPECT_LT(mean_variance / actual, 1.3) << pattern;
    if (pattern > 0) {
      EXPECT_LT(apart, 0.5 * actual) << "detectors of their own hide what set-ups share";
    }
  }
}

TEST(ClusteredVariance, OfRightAndWrongAnswersIsNotBelowThatOfChance) {
  // Residuals that cancel within each presentation and triangle: over clusters there is no scatter at all.
  std::vector<AnswerScore> answers;
  for (int i = 0; i < 16; ++i) {
    for (int j = 0; j < 8; ++j) {
      const double residual = (i + j) % 2 == 0 ? 1 : -1;
      answers.push_back({.direction = {1}, .residual = residual, .presentation = i, .place = j, .set_up = i / 2});
    }
  }

  const ClusteredVariance graded = clustered_variance(answers, 1, 0);
  const ClusteredVariance binary = clustered_variance(answers, 1, 0, AnswerScatter::binomial);

  EXPECT_EQ(graded.kind, IntervalKind::set_ups);
  EXPECT_LT(graded.variance, 0.02 / 128);
  EXPECT_EQ(binary.kind, IntervalKind::two_way);
  EXPECT_DOUBLE_EQ(binary.variance, 1.0 / 128);
  EXPECT_DOUBLE_EQ(binary.degrees_of_freedom, 15);
}

TEST(ClusteredVariance, OfOnePresentationIsThatOverPlaces) {
  std::vector<AnswerScore> answers;
  for (int j = 0; j < 40; ++j)
    answers.push_back({.direction = {1}, .residual = j / 2 % 2 == 0 ? 1.0 : -1.0, .presentation = 0, .place = j / 2});

  const ClusteredVariance found = clustered_variance(answers, 1, 0, AnswerScatter::binomial);

  // Pairs of equal answers: twice the variance of single ones, and 2 / 40 of leverage in each.
  EXPECT_NEAR(found.variance, 2.0 / 40 / (1 - 0.05), 1e-12);
  EXPECT_DOUBLE_EQ(found.degrees_of_freedom, 19);
  EXPECT_EQ(clustered_variance(answers, 1, 0).variance, INFINITY);
}

TEST(ClusteredVariance, SaysNothingWhereNothingIsKnown) {
  EXPECT_EQ(clustered_variance({}, 1, 0).variance, INFINITY);
  std::vector<AnswerScore> alike(10, {.direction = {1, 1, 0}, .residual = 0.1});
  EXPECT_EQ(clustered_variance(alike, 1, 0).variance, INFINITY) << "one cluster";
  for (std::size_t i = 0; i < alike.size(); ++i) alike[i].presentation = alike[i].place = static_cast<int>(i);
  EXPECT_EQ(clustered_variance(alike, 2, 0).variance, INFINITY) << "two parameters in one direction";
  EXPECT_LT(clustered_variance(alike, 1, 0).variance, INFINITY);
}

}  // namespace
}  // namespace todbench
