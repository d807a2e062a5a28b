// SPDX-License-Identifier: GPL-3.0-or-later
// A prior from earlier units, and the risks with it: against closed forms and counted draws.
#include "bench/judgement/fleet_prior.h"

#include <gmock/gmock.h>

#include <cmath>
#include <vector>

#include "acquisition/base/rng.h"
#include "bench/judgement/verdict_record.h"

namespace todbench {
namespace {

double phi(double z) {
  return 0.5 * std::erfc(-z / std::sqrt(2.0));
}

std::vector<UnitValue> drawn_units(double mean, double sd, double u, int count, std::uint64_t seed) {
  const RandomStream random(seed, "fleet");
  std::vector<UnitValue> units;
  for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(count); ++i)
    units.push_back({mean + sd * random.normal(2 * i) + u * random.normal(2 * i + 1), u});
  return units;
}

TEST(FleetPrior, FindsTheSpreadBehindTheUncertainty) {
  const auto prior = fleet_prior(drawn_units(0.5, 0.03, 0.04, 20000, 1));
  ASSERT_TRUE(prior);
  // The variance of 20000 values has a relative standard error of 1 %: 0.0025 of it is known to 0.000025.
  EXPECT_NEAR(prior->mean, 0.5, 4 * 0.05 / std::sqrt(20000.0));
  EXPECT_NEAR(prior->sd * prior->sd, 0.0009, 4 * 0.000025);
  EXPECT_NEAR(prior->u, 0.04, 1e-12);
}

/// 95 % of priors of twelve units hold the true spread in their interval.
TEST(FleetPrior, KnowsHowWellItKnowsTheSpread) {
  int holds = 0, all = 0;
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    const auto prior = fleet_prior(drawn_units(0, 1, 0.5, 12, seed));
    if (!prior) continue;
    ++all;
    const SpreadInterval spread = spread_interval(*prior);
    holds += spread.low <= 1 && 1 <= spread.high ? 1 : 0;
  }
  EXPECT_GT(all, 1950) << "a scatter below u has a probability of 0.03 %";
  EXPECT_NEAR(holds / static_cast<double>(all), 0.95, 4 * std::sqrt(0.95 * 0.05 / 2000));
}

TEST(FleetPrior, RefusesWhatSaysNothing) {
  const auto code = [](const std::vector<UnitValue>& units) {
    const auto prior = fleet_prior(units);
    return prior ? ErrorCode::internal : prior.error().code;
  };
  std::vector<UnitValue> units = drawn_units(0, 1, 0.1, least_fleet_units, 3);
  EXPECT_TRUE(fleet_prior(units));
  EXPECT_EQ(code({units.begin() + 1, units.end()}), ErrorCode::invalid_input) << "too few";
  units[4].u = 0;
  EXPECT_EQ(code(units), ErrorCode::invalid_input);
  EXPECT_EQ(code(std::vector<UnitValue>(20, {1, 0.1})), ErrorCode::invalid_input) << "no spread";
  EXPECT_EQ(code({}), ErrorCode::invalid_input);
}

TEST(FleetRisks, AreTheClosedFormOfAKnownFleet) {
  // So many units that the mean is known: the posterior of a normal prior and a normal measurement.
  const FleetPrior prior{.mean = 0.5, .sd = 0.03, .u = 0.01, .units = 1000000000};
  const auto risks = fleet_risks(prior, {.value = 0.43, .u = 0.01}, {.at_least = 0.44}, {.at_least = 0.46});
  ASSERT_TRUE(risks);
  const double weight = 0.0009 / 0.001, mean = weight * 0.43 + (1 - weight) * 0.5;
  EXPECT_NEAR(risks->p_conformity, phi((mean - 0.44) / std::sqrt(weight * 0.0001)), 1e-7);
  const auto known = global_risks({.mean = 0.5, .sd = 0.03}, {0.01}, {.at_least = 0.44}, {.at_least = 0.46});
  EXPECT_NEAR(risks->consumer_risk, known->consumer_risk, 1e-9);
  EXPECT_NEAR(risks->producer_risk, known->producer_risk, 1e-9);
  EXPECT_GE(risks->consumer_risk_most, risks->consumer_risk);
}

/// Units drawn from the fleet, each measured once: of those with a result near 0.43 as many conform as stated, and
/// over all as many are accepted and outside, rejected and inside.
TEST(FleetRisks, AreWhatHappensToDrawnUnits) {
  const FleetPrior prior{.mean = 0.48, .sd = 0.03, .u = 0.015, .units = 14};
  constexpr double u = 0.02, limit = 0.44, accepted_from = 0.45;
  const auto stated = fleet_risks(prior, {.value = 0.43, .u = u}, {.at_least = limit}, {.at_least = accepted_from});
  ASSERT_TRUE(stated);
  const double of_mean = std::sqrt((0.0009 + 0.000225) / 14);
  const RandomStream random(8, "drawn units");
  constexpr std::uint64_t draws = 400000;
  double near = 0, near_inside = 0, consumer = 0, producer = 0;
  for (std::uint64_t i = 0; i < draws; ++i) {
    const double truth = prior.mean + of_mean * random.normal(3 * i) + prior.sd * random.normal(3 * i + 1);
    const double found = truth + u * random.normal(3 * i + 2);
    const bool inside = truth >= limit, accepted = found >= accepted_from;
    consumer += accepted && !inside ? 1 : 0;
    producer += !accepted && inside ? 1 : 0;
    if (std::abs(found - 0.43) > 0.002) continue;
    ++near;
    near_inside += inside ? 1 : 0;
  }
  const auto tolerance = [](double p, double n) { return 4 * std::sqrt(p * (1 - p) / n); };
  EXPECT_NEAR(consumer / draws, stated->consumer_risk, tolerance(stated->consumer_risk, draws));
  EXPECT_NEAR(producer / draws, stated->producer_risk, tolerance(stated->producer_risk, draws));
  EXPECT_NEAR(near_inside / near, stated->p_conformity, tolerance(stated->p_conformity, near) + 0.001);
}

LimitsPlan limits_with_fleet() {
  LimitsPlan limits;
  limits.acuity = {{0.23, 0.30}};
  limits.fleets = {{.delta_t_k = 0.23, .mean = 0.33, .sd = 0.05, .u = 0.02, .units = 20},
                   {.measure = "netd", .mean = 0.06, .sd = 0.004, .units = 12}};
  return limits;
}

Demand acuity_demand(double acuity, double u) {
  constexpr double z95 = 1.959963984540054;
  Demand demand{.kind = DemandKind::acuity, .delta_t_k = 0.23, .limit = 0.30, .result = acuity};
  demand.interval = {acuity * std::exp(-z95 * u), acuity * std::exp(z95 * u)};
  demand.p_conformity = 0.5;
  return demand;
}

TEST(FleetRisks, StandWithTheDemandsThatTheFleetIsAbout) {
  const LimitsPlan limits = limits_with_fleet();
  Demand other = acuity_demand(0.31, 0.02), open = other;
  other.delta_t_k = 1.93;
  open.interval.high.reset();
  std::vector<Demand> demands{acuity_demand(0.31, 0.02), other, open};

  add_fleet_risks(demands, limits);

  ASSERT_TRUE(demands[0].fleet);
  EXPECT_FALSE(demands[1].fleet) << "another contrast";
  EXPECT_FALSE(demands[2].fleet) << "an open side";
  const double limit = std::log(0.30);
  const auto expected =
      fleet_risks({.mean = std::log(0.33), .sd = 0.05, .u = 0.02, .units = 20}, {.value = std::log(0.31), .u = 0.02},
                  {.at_least = limit}, {.at_least = limit + 1.959963984540054 * 0.02});
  EXPECT_NEAR(demands[0].fleet->p_conformity, expected->p_conformity, 1e-9);
  EXPECT_NEAR(demands[0].fleet->producer_risk, expected->producer_risk, 1e-9);
  EXPECT_EQ(demands[0].fleet->units, 20);
}

/// Student's t as a normal number over the root of a mean of squares.
double student(const RandomStream& random, std::uint64_t at, int freedom) {
  double squares = 0;
  for (int i = 1; i <= freedom; ++i) squares += std::pow(random.normal(at + static_cast<std::uint64_t>(i)), 2);
  return random.normal(at) / std::sqrt(squares / freedom);
}

/// Units drawn from the fleet and measured with an error of few degrees of freedom: as in a session.
TEST(FleetRisks, OfADemandWithFewDegreesOfFreedomAreWhatHappensToDrawnUnits) {
  constexpr int freedom = 3;
  constexpr double u = 0.02, t95 = 3.182446305284263;
  LimitsPlan limits = limits_with_fleet();
  std::vector<Demand> demands{acuity_demand(0.31, 0.02), acuity_demand(0.31, u)};
  demands[1].interval = {0.31 * std::exp(-t95 * u), 0.31 * std::exp(t95 * u)};
  demands[1].degrees_of_freedom = freedom;

  add_fleet_risks(demands, limits);

  ASSERT_TRUE(demands[1].fleet);
  const double of_fleet = std::sqrt(0.0025 + (0.0025 + 0.0004) / 20), limit = std::log(0.30), value = std::log(0.31);
  const RandomStream random(11, "drawn units");
  constexpr std::uint64_t draws = 400000;
  double near = 0, near_inside = 0, consumer = 0, producer = 0;
  for (std::uint64_t i = 0; i < draws; ++i) {
    const double truth = std::log(0.33) + of_fleet * random.normal(8 * i);
    const double found = truth + u * student(random, 8 * i + 1, freedom);
    const bool inside = truth >= limit, accepted = found >= limit + t95 * u;
    consumer += accepted && !inside ? 1 : 0;
    producer += !accepted && inside ? 1 : 0;
    if (std::abs(found - value) > 0.002) continue;
    ++near;
    near_inside += inside ? 1 : 0;
  }
  const auto tolerance = [](double p, double n) { return 4 * std::sqrt(p * (1 - p) / n); };
  const DemandFleet& stated = *demands[1].fleet;
  EXPECT_NEAR(consumer / draws, stated.consumer_risk, tolerance(stated.consumer_risk, draws));
  EXPECT_NEAR(producer / draws, stated.producer_risk, tolerance(stated.producer_risk, draws));
  EXPECT_NEAR(near_inside / near, stated.p_conformity, tolerance(stated.p_conformity, near) + 0.001);
  EXPECT_GT(stated.consumer_risk, 2 * demands[0].fleet->consumer_risk) << "the tails of few degrees of freedom";
}

TEST(FleetRisks, AreStoredWithTheVerdict) {
  std::vector<Demand> demands{acuity_demand(0.31, 0.02)};
  demands[0].conformity = ConformityDecision::inconclusive;
  add_fleet_risks(demands, limits_with_fleet());
  const Verdict verdict{.reason = "r", .demands = demands};

  const auto back = verdict_from(verdict_json(verdict));

  ASSERT_TRUE(back) << back.error().message;
  ASSERT_TRUE(back->demands[0].fleet);
  EXPECT_EQ(back->demands[0].fleet->units, 20);
  EXPECT_NEAR(back->demands[0].fleet->consumer_risk_most, demands[0].fleet->consumer_risk_most, 1e-12);
  EXPECT_NEAR(back->demands[0].fleet->p_conformity, demands[0].fleet->p_conformity, 1e-12);
}

}  // namespace
}  // namespace todbench
