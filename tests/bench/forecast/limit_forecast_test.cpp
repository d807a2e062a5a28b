// SPDX-License-Identifier: GPL-3.0-or-later
// What a plan says of its limits before anything is measured, against counted draws.
#include "bench/forecast/limit_forecast.h"

#include <gtest/gtest.h>

#include <cmath>

#include "acquisition/base/rng.h"
#include "bench/plan/descriptions.h"

namespace todbench {
namespace {

/// Shares of drawn units: a true value of the fleet, a measurement, a decision.
struct Counted {
  double p_good = 0, good_rejected = 0, bad_accepted = 0;
};

Counted counted(double mean, double sd, double u, double least, double accepted_from) {
  constexpr int draws = 200000;
  const RandomStream random(7, "test.fleet");
  int good = 0, rejected = 0, accepted = 0;
  for (std::uint64_t i = 0; i < draws; ++i) {
    const double truth = mean + sd * random.normal(2 * i), seen = truth + u * random.normal(2 * i + 1);
    good += truth >= least ? 1 : 0;
    rejected += truth >= least && seen < accepted_from ? 1 : 0;
    accepted += truth < least && seen >= accepted_from ? 1 : 0;
  }
  return {good / static_cast<double>(draws), rejected / static_cast<double>(good),
          accepted / static_cast<double>(draws)};
}

TEST(LimitForecasts, SayWhatShareOfTheGoodUnitsOfAFleetAPlanRejects) {
  Plan plan = *load_plan("demo");
  plan.limits = {};
  plan.limits.acuity = {{16.9, 0.6}};
  plan.limits.fleets = {{.delta_t_k = 16.9, .mean = 0.65, .sd = 0.04, .u = 0.02, .units = 40}};
  PlanPrediction prediction;
  prediction.contrasts = {{.delta_t_k = 16.9, .s75_mrad = 1.5, .uncertainty_percent = 4.0}};

  const auto forecasts = limit_forecasts(plan, prediction);

  ASSERT_TRUE(forecasts) << forecasts.error().message;
  ASSERT_EQ(forecasts->size(), 1u);
  const LimitForecast& found = forecasts->front();
  ASSERT_TRUE(found.planned.earlier && found.fourfold.earlier);
  for (const LimitOutlook* outlook : {&found.planned, &found.fourfold}) {
    // The mean of 40 units is known to sqrt((sd^2 + u^2) / 40).
    const double sd = std::sqrt(0.0016 + (0.0016 + 0.0004) / 40), u = outlook->u_ln_acuity;
    const Counted truth = counted(std::log(0.65), sd, u, std::log(0.6), std::log(0.6) + outlook->guard_band_ln);
    // Four standard errors of 200000 draws.
    EXPECT_NEAR(outlook->earlier->p_good, truth.p_good, 0.002);
    EXPECT_NEAR(outlook->earlier->good_rejected, truth.good_rejected, 0.004);
    EXPECT_NEAR(outlook->earlier->bad_accepted, truth.bad_accepted, 0.001);
    EXPECT_GT(outlook->earlier->good_rejected_most, outlook->earlier->good_rejected);
  }
  EXPECT_LT(found.fourfold.earlier->good_rejected, found.planned.earlier->good_rejected);
  plan.limits.fleets[0].delta_t_k = 2;
  EXPECT_FALSE(limit_forecasts(plan, prediction)->front().planned.earlier);
}

TEST(LimitForecasts, SayTheSameOfMeasuresWithTheUncertaintyOfEarlierSessions) {
  LimitsPlan limits;
  limits.measures = {{"netd", std::nullopt, 0.06}, {"distortion", std::nullopt, 2}, {"transfer_slope", 0.98, 1.02}};
  limits.fleets = {{.measure = "netd", .mean = 0.055, .sd = 0.003, .u = 0.001, .units = 20},
                   {.measure = "distortion", .mean = 1, .sd = 0.3, .u = 0.1, .units = 20},
                   {.measure = "transfer_slope", .mean = 1, .sd = 0.01, .u = 0, .units = 20}};

  const auto forecasts = measure_forecasts(limits);

  ASSERT_TRUE(forecasts) << forecasts.error().message;
  ASSERT_EQ(forecasts->size(), 1u) << "neither a size without sign nor a row without uncertainty";
  const MeasureForecast& netd = forecasts->front();
  EXPECT_EQ(netd.measure, "netd");
  const double sd = std::sqrt(9e-6 + (9e-6 + 1e-6) / 20);
  const Counted truth = counted(-0.055, sd, 0.001, -0.06, -0.06 + 1.959964e-3);
  EXPECT_NEAR(netd.as_before.good_rejected, truth.good_rejected, 0.004);
  EXPECT_NEAR(netd.as_before.p_good, truth.p_good, 0.002);
  EXPECT_LT(netd.half_u.good_rejected, netd.as_before.good_rejected);
}

}  // namespace
}  // namespace todbench
