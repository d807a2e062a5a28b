// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/round_robin/comparison.h"

#include <gmock/gmock.h>

#include <cmath>

namespace todbench {
namespace {

using ::testing::HasSubstr;

ComparedItem item_of(const std::string& name, const std::vector<std::pair<double, double>>& values) {
  ComparedItem out{name, "s75_mrad", "", {}};
  for (const auto& [value, u] : values) out.results.push_back({"L" + std::to_string(out.results.size() + 1), value, u});
  return out;
}

TEST(RoundRobin, OfConsistentResultsHasTheWeightedMeanAndTheDegreesOfCox) {
  const auto found = evaluated({item_of("a", {{10, 1}, {13, 2}})}, 1);

  ASSERT_TRUE(found);
  const ItemComparison& item = found->items[0];
  EXPECT_EQ(item.reference.method, ReferenceMethod::weighted_mean);
  EXPECT_NEAR(item.reference.value.value, 10.6, 1e-12);
  EXPECT_NEAR(item.reference.expanded_u, 2 * std::sqrt(0.8), 1e-12);
  // d = x - x_ref, U(d) = 2 sqrt(u^2 - u_ref^2).
  EXPECT_NEAR(item.degrees[0].difference, -0.6, 1e-12);
  EXPECT_NEAR(item.degrees[0].expanded_u, 2 * std::sqrt(0.2), 1e-12);
  EXPECT_NEAR(item.degrees[1].difference, 2.4, 1e-12);
  EXPECT_NEAR(item.degrees[1].expanded_u, 2 * std::sqrt(3.2), 1e-12);
  EXPECT_NEAR(item.degrees[1].e_n, 2.4 / (2 * std::sqrt(3.2)), 1e-12);
  EXPECT_NEAR(item.degrees[1].zeta, 2.4 / std::sqrt(3.2), 1e-12);
  EXPECT_TRUE(found->consistent());
}

TEST(RoundRobin, OfOneLaboratoryWithNearlyAllTheWeightHasFiniteDegrees) {
  const auto found = evaluated({item_of("a", {{10, 1e-12}, {11, 1}, {9.5, 1}})}, 1);

  ASSERT_TRUE(found);
  const auto& degrees = found->items[0].degrees;
  // From the mean of the others, 10.25 +- 0.71: zeta = -0.25 / 0.7071.
  EXPECT_NEAR(degrees[0].zeta, -0.25 / std::sqrt(0.5), 1e-9);
  for (const auto& degree : degrees) EXPECT_GT(degree.expanded_u, 0);
}

TEST(RoundRobin, NamesALaboratoryThatIsOffInEveryItem) {
  const std::vector<std::pair<double, double>> one{{5.02, 0.1}, {4.95, 0.1}, {5.35, 0.1}, {5.01, 0.1}, {4.98, 0.1}};

  const auto found = evaluated({item_of("a", one), item_of("b", one), item_of("c", one)}, 1);

  ASSERT_TRUE(found);
  ASSERT_EQ(found->outlying.size(), 1u);
  EXPECT_EQ(found->outlying[0].laboratory, "L3");
  EXPECT_EQ(found->outlying[0].item, "");
  // From 4.99 +- 0.05 of the four others, three times: 0.36 / 0.1118 * sqrt(3).
  EXPECT_NEAR(found->outlying[0].zeta, 0.36 / std::sqrt(0.0125) * std::sqrt(3.0), 1e-9);
  EXPECT_NEAR(found->items[0].reference.value.value, 4.99, 1e-9);
  EXPECT_TRUE(found->items[0].degrees[2].outlying);
  EXPECT_FALSE(found->items[0].degrees[2].in_reference);
  // Not correlated with the reference value: U = 2 sqrt(u^2 + u_ref^2).
  EXPECT_NEAR(found->items[0].degrees[2].expanded_u, 2 * std::sqrt(0.0125), 1e-12);
  EXPECT_FALSE(found->consistent());
}

TEST(RoundRobin, NamesASingleResultAndKeepsTheOthersOfItsLaboratory) {
  const std::vector<std::pair<double, double>> good{{5.02, 0.1}, {4.95, 0.1}, {5.0, 0.1}, {5.01, 0.1}};
  auto bad = good;
  bad[1].first = 6;

  const auto found = evaluated({item_of("a", good), item_of("b", bad)}, 1);

  ASSERT_TRUE(found);
  ASSERT_EQ(found->outlying.size(), 1u);
  EXPECT_EQ(found->outlying[0].laboratory, "L2");
  EXPECT_EQ(found->outlying[0].item, "b");
  EXPECT_TRUE(found->items[0].degrees[1].in_reference);
  EXPECT_FALSE(found->items[1].degrees[1].in_reference);
}

TEST(RoundRobin, OfLaboratoriesThatScatterHasTheMeanOfPauleAndMandel) {
  // Two camps of equal size: none is outlying, because more than half of the laboratories must remain.
  const auto found = evaluated({item_of("a", {{1, 0.1}, {1.02, 0.1}, {2, 0.1}, {2.02, 0.1}})}, 1);

  ASSERT_TRUE(found);
  const ItemComparison& item = found->items[0];
  EXPECT_EQ(item.reference.method, ReferenceMethod::paule_mandel);
  EXPECT_NEAR(item.reference.value.value, 1.51, 1e-9);
  // Equal u: standard error sqrt(s^2 / N), t(0.975, 3) = 3.182446.
  const double s2 = (2 * 0.51 * 0.51 + 2 * 0.49 * 0.49) / 3;
  EXPECT_NEAR(item.reference.expanded_u, 3.182446 * std::sqrt(s2 / 4), 1e-6);
  EXPECT_FALSE(item.kept.consistent());
  EXPECT_FALSE(found->consistent());
}

TEST(RoundRobin, ThatNamesSeveralLaboratoriesHasReferenceValuesFromAllResults) {
  // 8 and 12 of eight: both are named, and the other six are too similar by selection.
  const auto found = evaluated(
      {item_of("a", {{10, 0.2}, {10.1, 0.2}, {9.9, 0.2}, {10, 0.2}, {10.1, 0.2}, {9.9, 0.2}, {8, 0.2}, {12, 0.2}})}, 1);

  ASSERT_TRUE(found);
  ASSERT_EQ(found->outlying.size(), 2u);
  const ItemComparison& item = found->items[0];
  EXPECT_EQ(item.reference.method, ReferenceMethod::paule_mandel);
  EXPECT_NEAR(item.reference.value.value, 10, 1e-9);
  // Equal u: t(0.975, 7) sqrt(s^2 / 8), s^2 = (4 * 0.1^2 + 2 * 2^2) / 7.
  EXPECT_NEAR(item.reference.expanded_u, 2.364624 * std::sqrt(8.04 / 7 / 8), 1e-6);
  EXPECT_TRUE(item.degrees[6].outlying && item.degrees[7].outlying && !item.degrees[0].outlying);
  EXPECT_TRUE(item.degrees[6].in_reference);
}

TEST(RoundRobin, OfAFewDiscrepantResultsHasTheMedian) {
  // chi2 = 4 * 2.3^2 = 21 with nine degrees of freedom, p = 0.012. The largest zeta is 2.3 / 0.9487, p = 0.14 of ten.
  const auto found = evaluated(
      {item_of("a", {{0, 1}, {0, 1}, {0, 1}, {0, 1}, {0, 1}, {0, 1}, {2.3, 1}, {-2.3, 1}, {2.3, 1}, {-2.3, 1}})}, 1);

  ASSERT_TRUE(found);
  const ItemComparison& item = found->items[0];
  EXPECT_TRUE(found->outlying.empty());
  EXPECT_EQ(item.reference.method, ReferenceMethod::median);
  EXPECT_NEAR(item.reference.value.value, 0, 0.02);
  // Without one of them, 15.3 of a permitted 15.5 with eight degrees of freedom.
  EXPECT_EQ(item.consistent_laboratories.size(), 9u);
}

TEST(RoundRobin, OfOneLaboratoryIsRefused) {
  const auto found = evaluated({item_of("a", {{1, 0.1}})}, 1);

  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(found.error().message, HasSubstr("item 'a', quantity 's75_mrad': expected results of at least two"));
  EXPECT_FALSE(evaluated({}, 1));
}

}  // namespace
}  // namespace todbench
