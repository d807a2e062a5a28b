// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/round_robin/consensus.h"

#include <gmock/gmock.h>

#include <array>
#include <cmath>

#include "tod/observer_fit/people.h"

namespace todbench {
namespace {

using ::testing::ElementsAre;

std::vector<LaboratoryValue> laboratories(const std::vector<std::pair<double, double>>& values) {
  std::vector<LaboratoryValue> out;
  for (const auto& [value, u] : values) out.push_back({"L" + std::to_string(out.size() + 1), value, u});
  return out;
}

/// 13 trials of the BCG vaccine: vaccinated and control groups, ill and well (Colditz et al. 1994; data set dat.bcg of
/// the package metafor, Viechtbauer 2010). The values are ln of the relative risk.
std::vector<LaboratoryValue> bcg_trials() {
  constexpr std::array<std::array<double, 4>, 13> trials{{{4, 119, 11, 128},
                                                          {6, 300, 29, 274},
                                                          {3, 228, 11, 209},
                                                          {62, 13536, 248, 12619},
                                                          {33, 5036, 47, 5761},
                                                          {180, 1361, 372, 1079},
                                                          {8, 2537, 10, 619},
                                                          {505, 87886, 499, 87892},
                                                          {29, 7470, 45, 7232},
                                                          {17, 1699, 65, 1600},
                                                          {186, 50448, 141, 27197},
                                                          {5, 2493, 3, 2338},
                                                          {27, 16886, 29, 17825}}};
  std::vector<std::pair<double, double>> values;
  for (const auto& [a, b, c, d] : trials)
    values.emplace_back(std::log(a / (a + b) / (c / (c + d))), std::sqrt(1 / a - 1 / (a + b) + 1 / c - 1 / (c + d)));
  return laboratories(values);
}

TEST(WeightedMean, OfTwoUnequalLaboratoriesIsThatOfTheFormula) {
  const auto two = laboratories({{10, 1}, {13, 2}});

  const Consensus mean = weighted_mean(two);
  const ConsistencyCheck check = consistency(two);

  // (10 + 13 / 4) / (1 + 1 / 4); chi2 = (13 - 10)^2 / (1 + 4); its tail with one degree of freedom is
  // erfc(sqrt(chi2/2)).
  EXPECT_NEAR(mean.value, 10.6, 1e-12);
  EXPECT_NEAR(mean.u, std::sqrt(0.8), 1e-12);
  EXPECT_NEAR(check.chi2, 1.8, 1e-12);
  EXPECT_EQ(check.degrees_of_freedom, 1);
  EXPECT_NEAR(check.p, std::erfc(std::sqrt(0.9)), 1e-12);
  EXPECT_NEAR(check.birge_ratio, std::sqrt(1.8), 1e-12);
}

TEST(WeightedMean, KeepsTheDigitsOfCloseValues) {
  const Consensus mean = weighted_mean(laboratories({{1e9 + 0.1, 1e-3}, {1e9 + 0.2, 1e-3}, {1e9 + 0.3, 1e-3}}));

  EXPECT_NEAR(mean.value - 1e9, 0.2, 3e-7);  // a double has steps of 1.2e-7 here
}

TEST(Consistency, OfTheBcgTrialsIsThePublishedQ) {
  const ConsistencyCheck check = consistency(bcg_trials());

  EXPECT_NEAR(check.chi2, 152.2330, 5e-5);
  EXPECT_EQ(check.degrees_of_freedom, 12);
  EXPECT_FALSE(check.consistent());
}

TEST(RandomEffectsOfLaboratories, OfTheBcgTrialsAreThePublishedOnes) {
  const auto trials = bcg_trials();

  const double dl = dersimonian_laird_variance(trials), pm = paule_mandel_variance(trials);
  const RandomEffects by_dl = random_effects(trials, dl);

  EXPECT_NEAR(dl, 0.3088, 5e-5);
  EXPECT_NEAR(by_dl.mean.value, -0.7141, 5e-5);
  EXPECT_NEAR(by_dl.mean.u, 0.1787, 5e-5);
  EXPECT_NEAR(pm, 0.3181, 5e-5);
}

TEST(RandomEffectsOfLaboratories, OfEqualUncertaintiesAreTheVarianceInExcess) {
  // Equal u: both estimates are the variance of the values minus u^2, and the mean is the arithmetic one with the
  // standard error sqrt(s^2 / N).
  const auto four = laboratories({{1, 0.5}, {2, 0.5}, {4, 0.5}, {5, 0.5}});
  const double s2 = 10.0 / 3;

  const double dl = dersimonian_laird_variance(four), pm = paule_mandel_variance(four);
  const RandomEffects found = random_effects(four, pm);

  EXPECT_NEAR(dl, s2 - 0.25, 1e-12);
  EXPECT_NEAR(pm, s2 - 0.25, 1e-12);
  EXPECT_NEAR(found.mean.value, 3, 1e-12);
  EXPECT_NEAR(found.mean.u, std::sqrt(s2 / 4), 1e-12);
  EXPECT_NEAR(found.hartung_knapp, std::sqrt(s2 / 4), 1e-12);
}

TEST(RandomEffectsOfLaboratories, OfConsistentResultsAreTheWeightedMean) {
  const auto three = laboratories({{1, 0.5}, {1.1, 0.25}, {0.9, 0.5}});

  EXPECT_EQ(dersimonian_laird_variance(three), 0);
  EXPECT_EQ(paule_mandel_variance(three), 0);
  EXPECT_NEAR(random_effects(three, 0).mean.value, weighted_mean(three).value, 1e-15);
  EXPECT_NEAR(random_effects(three, 0).mean.u, weighted_mean(three).u, 1e-15);
}

TEST(RandomEffectsOfLaboratories, AgreeWithTheRestrictedLikelihoodOfThePeople) {
  // Another estimator of another room: restricted maximum likelihood. Of 13 trials the two differ by a few percent.
  std::vector<PersonEstimate> same;
  for (const auto& trial : bcg_trials()) same.push_back({trial.value, trial.u});

  const PeopleSpread by_likelihood = spread_over(same);

  EXPECT_NEAR(*by_likelihood.between_sd, std::sqrt(paule_mandel_variance(bcg_trials())), 0.02 * 0.56);
}

TEST(MonteCarloMedian, OfEqualLaboratoriesHasTheVarianceOfOrderStatistics) {
  // Variance of the median of 3 and 5 standard normals: 0.448671 and 0.286834 (Sarhan and Greenberg 1962, table 10C.1).
  // Relative standard error of a standard deviation from 20000 draws: 1 / sqrt(2 * 20000) = 0.5 %; of the mean 0.005.
  const auto three = monte_carlo_median(laboratories({{7, 1}, {7, 1}, {7, 1}}), 3, MedianDetail::median);
  const auto five = monte_carlo_median(laboratories({{0, 2}, {0, 2}, {0, 2}, {0, 2}, {0, 2}}), 3, MedianDetail::median);

  EXPECT_NEAR(three.median.u, std::sqrt(0.448671), 4 * 0.005 * 0.67);
  EXPECT_NEAR(three.median.value, 7, 4 * 0.005);
  EXPECT_NEAR(five.median.u, 2 * std::sqrt(0.286834), 4 * 0.005 * 1.07);
  // The median of normals is nearly normal: its 95 % interval is 3.92 standard deviations long, within 2 %.
  EXPECT_NEAR((*five.ci95.high - *five.ci95.low) / five.median.u, 2 * 1.96, 0.08);
}

TEST(MonteCarloMedian, IsTheSameForASeedAndIgnoresAFarLaboratory) {
  const auto values = laboratories({{1, 0.1}, {1.05, 0.1}, {0.95, 0.1}, {1, 0.1}, {90, 0.1}});

  const auto first = monte_carlo_median(values, 5, MedianDetail::differences),
             again = monte_carlo_median(values, 5, MedianDetail::median);

  EXPECT_EQ(first.median.value, again.median.value);
  EXPECT_NEAR(first.median.value, 1.05, 0.05);
  // 89 of difference, half an interval of sqrt(0.1^2 + u^2(median)) in standard deviations.
  EXPECT_NEAR(first.difference_half95[4], 1.96 * std::hypot(0.1, first.median.u), 0.01);
}

TEST(LargestConsistentSubset, LeavesOutTheFarOnes) {
  const auto six = laboratories({{1, 0.1}, {5, 0.1}, {1.1, 0.1}, {0.95, 0.1}, {1.02, 0.2}, {-4, 0.3}});

  EXPECT_THAT(largest_consistent_subset(six), ElementsAre(0, 2, 3, 4));
}

TEST(LargestConsistentSubset, OfMoreThanSixteenIsFoundByRemoval) {
  std::vector<std::pair<double, double>> values(20, {1, 0.1});
  for (std::size_t i = 0; i < values.size(); ++i) values[i].first += 0.01 * static_cast<double>(i % 5);
  values[3].first = 9;
  values[17].first = -7;

  const auto found = largest_consistent_subset(laboratories(values));

  EXPECT_EQ(found.size(), 18u);
  EXPECT_THAT(found, ::testing::Not(::testing::Contains(3u)));
  EXPECT_THAT(found, ::testing::Not(::testing::Contains(17u)));
}

TEST(LargestConsistentSubset, OfTwoThatContradictIsOne) {
  EXPECT_EQ(largest_consistent_subset(laboratories({{1, 0.1}, {5, 0.1}})).size(), 1u);
}

}  // namespace
}  // namespace todbench
