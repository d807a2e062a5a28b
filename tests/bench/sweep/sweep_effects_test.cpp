// SPDX-License-Identifier: GPL-3.0-or-later
// What a sweep says of its parameters: main effects, Sobol indices, their intervals.
#include "bench/sweep/sweep_effects.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "acquisition/base/rng.h"
#include "tests/bench/sweep/sweep_support.h"

namespace todbench {
namespace {

using namespace testing_support;

TEST(SweepEffects, OfAnAdditiveResponseAreItsSharesOfVariance) {
  const Sweep sweep = expanded("[grid]\na = [0, 1]\nb = [0, 1]\n[repeat]\nseeds = 3\n");
  SweepTable table;
  table.columns = {"a", "b", "repeat", "y"};
  for (int repeat = 0; repeat < 3; ++repeat) {
    for (const int a : {0, 1}) {
      for (const int b : {0, 1}) table.rows.push_back({a, b, repeat, 3.0 * a + 1.0 * b});
    }
  }

  const auto effects = sweep_effects(sweep, table, "y");

  ASSERT_EQ(effects.size(), 1u);
  // Variances 9/4 and 1/4 of 10/4; without interactions the total is the first order.
  EXPECT_NEAR(effects[0].parameters[0].first_order.value(), 0.9, 1e-12);
  EXPECT_NEAR(effects[0].parameters[1].first_order.value(), 0.1, 1e-12);
  EXPECT_NEAR(effects[0].parameters[0].total.value(), 0.9, 1e-12);
  EXPECT_NEAR(effects[0].parameters[0].levels[1].mean, 3.5, 1e-12);
  EXPECT_NEAR(effects[0].parameters[0].levels[1].ci95.low.value(), 3.5, 1e-12);
}

TEST(SweepEffects, OfADrawnSampleComeFromClasses) {
  const Sweep sweep = expanded("[sample]\nkind = \"sobol\"\nn = 512\nranges = { a = [0, 1], b = [0, 1] }\n");
  SweepTable table;
  table.columns = {"a", "b", "repeat", "y"};
  for (std::size_t i = 0; i < sweep.count(); ++i) {
    const auto values = values_of(sweep, i);
    const double a = *parse_number(values[0]), b = *parse_number(values[1]);
    table.rows.push_back({a, b, 0, 2 * a + b});
  }

  const auto effects = sweep_effects(sweep, table, "y");

  // Shares 4/5 and 1/5; sixteen classes leave 1/256 of a parameter's own variance within them. In a net the other
  // parameter is alike in all classes: nothing is taken off for chance.
  EXPECT_NEAR(effects[0].parameters[0].first_order.value(), 0.8 * 255 / 256, 1e-4);
  EXPECT_NEAR(effects[0].parameters[1].first_order.value(), 0.2 * 255 / 256, 1e-4);
  // The response is a plane: its ends are exact, b at its middle.
  ASSERT_EQ(effects[0].parameters[0].ends.size(), 2u);
  EXPECT_NEAR(effects[0].parameters[0].ends[0].mean, 0.5, 1e-9);
  EXPECT_NEAR(effects[0].parameters[0].ends[1].mean, 2.5, 1e-9);
  EXPECT_GT(effects[0].parameters[0].levels.size(), 2u);
}

// Scatter of repeats alone: sixteen classes of 512 draws would explain 3 % of it by chance.
TEST(SweepEffects, OfNothingAreNothing) {
  const Sweep sweep =
      expanded("[sample]\nkind = \"sobol\"\nn = 512\nranges = { a = [0, 1], b = [0, 1] }\n[repeat]\nseeds = 4\n");
  SweepTable table;
  table.columns = {"a", "b", "repeat", "y"};
  const RandomStream noise(5, "sweep_test.noise");
  for (std::size_t i = 0; i < sweep.count(); ++i) {
    const auto values = values_of(sweep, i);
    table.rows.push_back({*parse_number(values[0]), *parse_number(values[1]), sweep.task(i).repeat, noise.normal(i)});
  }

  const auto effects = sweep_effects(sweep, table, "y");

  // eta^2 (n - 1) is chi-squared with 15 degrees of freedom: standard deviation sqrt(30) / 511 of one repeat.
  for (const auto& parameter : effects[0].parameters)
    EXPECT_NEAR(parameter.first_order.value(), 0, 3 * std::sqrt(30.0) / 511 / 2);
}

std::string total_sample(std::size_t n, int seed, const std::string& ranges) {
  return "[sample]\nkind = \"sobol\"\ntotal = true\nn = " + std::to_string(n) + "\nseed = " + std::to_string(seed) +
         "\nranges = { " + ranges + " }\n";
}

struct KnownIndices {
  std::string ranges;
  Response response;
  std::vector<double> first, total;
};

/// Ishigami and Homma 1990 with a = 7, b = 0.1.
KnownIndices ishigami() {
  constexpr double pi = 3.14159265358979323846, a = 7, b = 0.1;
  const double v1 = std::pow(1 + b * std::pow(pi, 4) / 5, 2) / 2, v2 = a * a / 8,
               v13 = 8 * b * b * std::pow(pi, 8) / 225, v = v1 + v2 + v13;
  const std::string range = " = [-3.141592653589793, 3.141592653589793]";
  return {"a" + range + ", b" + range + ", c" + range,
          [](const std::vector<double>& x, std::size_t) {
            return std::sin(x[0]) + a * std::pow(std::sin(x[1]), 2) + b * std::pow(x[2], 4) * std::sin(x[0]);
          },
          {v1 / v, v2 / v, 0},
          {(v1 + v13) / v, v2 / v, v13 / v}};
}

/// The g-function of Sobol 1993 with a = 0, 1, 4.5, 9, 99.
KnownIndices sobol_g() {
  const std::vector<double> a{0, 1, 4.5, 9, 99};
  KnownIndices known{"a = [0, 1], b = [0, 1], c = [0, 1], d = [0, 1], e = [0, 1]",
                     [a](const std::vector<double>& x, std::size_t) {
                       double product = 1;
                       for (std::size_t i = 0; i < a.size(); ++i)
                         product *= (std::abs(4 * x[i] - 2) + a[i]) / (1 + a[i]);
                       return product;
                     },
                     {},
                     {}};
  double all = 1;
  for (const double one : a) all *= 1 + 1 / (3 * (1 + one) * (1 + one));
  for (const double one : a) {
    const double v = 1 / (3 * (1 + one) * (1 + one));
    known.first.push_back(v / (all - 1));
    known.total.push_back(v * all / (1 + v) / (all - 1));
  }
  return known;
}

TEST(SweepTotalIndices, AreThoseOfFunctionsWhoseIndicesAreKnown) {
  for (const KnownIndices& known : {ishigami(), sobol_g()}) {
    const Sweep sweep = expanded(total_sample(2048, 1, known.ranges));
    EXPECT_EQ(sweep.count(), 2048 * (known.first.size() + 2));

    const auto effects = sweep_effects(sweep, table_of(sweep, known.response), "y");

    ASSERT_EQ(effects.size(), 1u);
    EXPECT_EQ(effects[0].draws, 2048u);
    for (std::size_t k = 0; k < known.first.size(); ++k) {
      const ParameterEffect& found = effects[0].parameters[k];
      EXPECT_NEAR(found.first_order.value(), known.first[k], 0.02) << k;
      EXPECT_NEAR(found.total.value(), known.total[k], 0.02) << k;
    }
  }
}

// Forty seeds, sixteen indices each: of intervals that held in 95 % of independent ones 608 would, with a standard
// deviation below 10 were they independent; those of a net are rather too wide.
TEST(SweepTotalIndices, LieWithinTheirIntervals) {
  int held = 0, all = 0;
  for (const KnownIndices& known : {ishigami(), sobol_g()}) {
    for (int seed = 1; seed <= 40; ++seed) {
      const Sweep sweep = expanded(total_sample(128, seed, known.ranges));
      const auto effects = sweep_effects(sweep, table_of(sweep, known.response), "y");
      for (std::size_t k = 0; k < known.first.size(); ++k) {
        const ParameterEffect& found = effects[0].parameters[k];
        for (const auto& [interval, truth] :
             {std::pair(found.first_order_ci95, known.first[k]), std::pair(found.total_ci95, known.total[k])}) {
          ++all;
          held += *interval.low <= truth && truth <= *interval.high ? 1 : 0;
        }
      }
    }
  }
  RecordProperty("intervals_that_held", held);
  EXPECT_EQ(all, 640);
  EXPECT_GE(held, 588);
}

TEST(SweepTotalIndices, OfNoiseOfTasksAreNobodysShare) {
  const RandomStream noise(7, "sweep_test.total");
  const Sweep sweep = expanded(total_sample(512, 1, "a = [0, 1], b = [0, 1]") + "[repeat]\nseeds = 2\n");

  const auto effects = sweep_effects(
      sweep,
      table_of(sweep, [&](const auto& x, std::size_t i) { return x[0] + noise.normal(i) * std::sqrt(1.0 / 12); }), "y");

  // Half of the variance is that of a, half nobody's; 0.05 is three standard errors of 512 draws in two repeats.
  EXPECT_NEAR(effects[0].parameters[0].first_order.value(), 0.5, 0.06);
  EXPECT_NEAR(effects[0].parameters[0].total.value(), 0.5, 0.06);
  EXPECT_NEAR(effects[0].parameters[1].first_order.value(), 0, 0.06);
  EXPECT_NEAR(effects[0].parameters[1].total.value(), 0, 0.06);
}

TEST(SweepTotalIndices, AreOfWholeDrawsAndAskForThem) {
  const Sweep sweep = expanded(total_sample(64, 1, "a = [0, 1], b = [0, 1]"));
  SweepTable table = table_of(sweep, [](const auto& x, std::size_t) { return x[0]; });
  table.rows.erase(table.rows.begin() + 5);

  EXPECT_EQ(sweep_effects(sweep, table, "y")[0].draws, 63u);
  const Sweep more = expanded(total_sample(65, 1, "a = [0, 1], b = [0, 1]"));
  for (std::size_t i = 0; i < sweep.count(); ++i) EXPECT_EQ(sweep.task(i).name, more.task(i).name) << "draws are added";
  EXPECT_EQ(values_of(sweep, 2)[0], values_of(sweep, 1)[0]) << "A with the first parameter of B";
  EXPECT_EQ(values_of(sweep, 2)[1], values_of(sweep, 0)[1]);
  EXPECT_NE(refusal("[sample]\nn = 4\ntotal = true\nranges = { a = [0, 1] }\n"), "");
  EXPECT_NE(refusal("[sample]\nkind = \"sobol\"\nn = 4\ntotal = 1\nranges = { a = [0, 1] }\n"), "");
  EXPECT_NE(refusal("where = \"a < 1\"\n" + total_sample(4, 1, "a = [0, 1]")), "");
  EXPECT_NE(refusal("[grid]\nb = [1]\n" + total_sample(4, 1, "a = [0, 1]")), "");
  EXPECT_NE(refusal(total_sample(4'000'000, 1, "a = [0, 1]")), "") << "more than ten million tasks";
}

}  // namespace
}  // namespace todbench
