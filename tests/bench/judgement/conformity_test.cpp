// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/judgement/conformity.h"

#include <gmock/gmock.h>

#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "bench/judgement/uncertainty_budget.h"
#include "tests/tod/measures/measures_reference.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;

std::optional<double> optional_of(const nlohmann::json& json) {
  return json.is_null() ? std::nullopt : std::optional<double>(json.get<double>());
}

ToleranceLimits limits_of(const nlohmann::json& json) {
  return {optional_of(json["lower_limit"]), optional_of(json["upper_limit"])};
}

TEST(Conformity, DecidesAsTheReferenceByEveryRule) {
  const std::map<ConformityRule, std::string> names{{ConformityRule::guarded_acceptance_and_rejection, "guarded_both"},
                                                    {ConformityRule::simple, "simple"},
                                                    {ConformityRule::guarded, "guarded_acceptance"},
                                                    {ConformityRule::non_binary, "non_binary"}};
  for (const auto& reference : test::reference_cases("conformity", "single")) {
    for (const auto& [rule, name] : names) {
      const auto found = conformity({reference["value"], reference["standard_uncertainty"], {}}, limits_of(reference),
                                    rule, reference["guard_band"])
                             .value();

      EXPECT_EQ(to_string(found.decision), reference["decisions"][name].get<std::string>()) << name;
      EXPECT_NEAR(found.p_conformity, reference["conformity_probability"], 1e-8);
      EXPECT_NEAR(found.p_nonconformity, reference["probability_of_false_accept_if_passed"], 1e-8);
      if (rule == ConformityRule::simple) continue;
      EXPECT_EQ(found.acceptance_zone_is_empty, reference["acceptance_zone_is_empty"]);
      const auto low = optional_of(reference["acceptance_limits"][0]),
                 high = optional_of(reference["acceptance_limits"][1]);
      EXPECT_NEAR(found.acceptance.at_least.value_or(0), low.value_or(0), 1e-12);
      EXPECT_NEAR(found.acceptance.at_most.value_or(0), high.value_or(0), 1e-12);
    }
  }
}

TEST(Conformity, TakesAValueOnItsLimitForInsideWhateverRoundingSays) {
  // 0.9 + 0.04 is above 0.94 in binary numbers.
  const auto found = conformity({0.94, 0.02, {}}, {0.9, 1.1}, ConformityRule::guarded, 0.04).value();
  EXPECT_EQ(found.decision, ConformityDecision::pass);
  const auto beside = conformity({0.9399999, 0.02, {}}, {0.9, 1.1}, ConformityRule::guarded, 0.04).value();
  EXPECT_EQ(beside.decision, ConformityDecision::fail);
}

TEST(Conformity, KeepsTheDigitsOfSmallProbabilitiesAndKnowsFewDegreesOfFreedom) {
  const auto far = conformity({0, 1, {}}, {10, 11}, ConformityRule::simple, 0).value();
  // The normal distribution beyond 10 is 7.62e-24, beyond 11 it is 1.9e-28.
  EXPECT_NEAR(far.p_conformity, 7.6198e-24, 1e-27);
  // Student's t with one degree of freedom: 1/2 + atan(z) / pi.
  const auto few = conformity({1, 1, 1.0}, {0, {}}, ConformityRule::simple, 0).value();
  EXPECT_NEAR(few.p_conformity, 0.75, 1e-12);
}

TEST(Conformity, RefusesWhatCannotBeJudged) {
  const auto refused = [](MeasuredValue measured, ToleranceLimits limits, double band) {
    return !conformity(measured, limits, ConformityRule::guarded, band);
  };
  EXPECT_TRUE(refused({1, 1, {}}, {}, 0));
  EXPECT_TRUE(refused({1, 0, {}}, {0, {}}, 0));
  EXPECT_TRUE(refused({1, -1, {}}, {0, {}}, 0));
  EXPECT_TRUE(refused({std::nan(""), 1, {}}, {0, {}}, 0));
  EXPECT_TRUE(refused({1, 1, {}}, {2, 1}, 0));
  EXPECT_TRUE(refused({1, 1, {}}, {1, {}}, -1));
  EXPECT_TRUE(refused({1, 1, 0.0}, {1, {}}, 1));
}

TEST(GuardBand, LeavesTheRiskOfTheReference) {
  for (const auto& reference : test::reference_cases("conformity", "guard_bands"))
    EXPECT_NEAR(guard_band_for_risk(reference["wanted_risk_at_acceptance_limit"], {0, 2, {}}),
                2 * reference["guard_band_over_u"].get<double>(), 1e-8);
}

TEST(GlobalRisks, AreThoseOfTheReference) {
  for (const auto& reference : test::reference_cases("conformity", "global_risks")) {
    const ToleranceLimits tolerance = limits_of(reference);
    const double band = reference["guard_band"];
    ToleranceLimits acceptance = tolerance;
    if (acceptance.at_least) *acceptance.at_least += band;
    if (acceptance.at_most) *acceptance.at_most -= band;

    const auto found = global_risks({reference["population_mean"], reference["population_sd"]},
                                    {reference["measurement_u"]}, tolerance, acceptance)
                           .value();

    EXPECT_NEAR(found.p_conforming, reference["probability_conforming"], 1e-8);
    EXPECT_NEAR(found.p_accepted, reference["probability_accepted"], 1e-8);
    EXPECT_NEAR(found.consumer_risk, reference["consumer_risk"], 1e-8);
    EXPECT_NEAR(found.producer_risk, reference["producer_risk"], 1e-8);
    EXPECT_NEAR(found.p_nonconforming_if_accepted, reference["probability_bad_given_accepted"], 1e-8);
  }
}

// A sum over a fine grid of true values and an independent form of the distribution for 3 degrees of freedom:
// F(t) = 1/2 + (atan(t / sqrt 3) + (t / sqrt 3) / (1 + t^2 / 3)) / pi. The grid is good to 1e-9 of a risk.
TEST(GlobalRisks, OfAnUncertaintyWithFewDegreesOfFreedomFollowStudentsT) {
  const auto cdf3 = [](double t) {
    const double x = t / std::sqrt(3.0);
    return 0.5 + (std::atan(x) + x / (1 + x * x)) / std::numbers::pi;
  };
  const double mean = 0.5, sd = 0.03, u = 0.01, limit = 0.44, accepted_from = 0.46;
  double consumer = 0, producer = 0;
  constexpr int steps = 400000;
  const double step = 20 * sd / steps;
  for (int i = 0; i < steps; ++i) {
    const double x = mean - 10 * sd + (i + 0.5) * step, z = (x - mean) / sd;
    const double density = std::exp(-0.5 * z * z) / (sd * std::sqrt(2 * std::numbers::pi)) * step;
    const double accepted = 1 - cdf3((accepted_from - x) / u);
    (x < limit ? consumer : producer) += density * (x < limit ? accepted : 1 - accepted);
  }

  const auto of_t = global_risks({mean, sd}, {u, 3.0}, {.at_least = limit}, {.at_least = accepted_from});
  const auto normal = global_risks({mean, sd}, {u}, {.at_least = limit}, {.at_least = accepted_from});

  EXPECT_NEAR(of_t->consumer_risk, consumer, 1e-8);
  EXPECT_NEAR(of_t->producer_risk, producer, 1e-8);
  EXPECT_GT(of_t->consumer_risk, 4 * normal->consumer_risk);
  EXPECT_FALSE(global_risks({mean, sd}, {u, 0.0}, {.at_least = limit}, {.at_least = accepted_from}));
}

// One draw: error over u is a normal number over the root of a chi-squared number over its degrees of freedom.
TEST(GlobalRisks, OfFewDegreesOfFreedomAreThoseOfDrawnUnits) {
  std::mt19937_64 engine(7);
  std::normal_distribution<double> normal;
  constexpr int draws = 400000;
  const double mean = 0, sd = 1, u = 0.5;
  int consumer = 0, producer = 0;
  for (int i = 0; i < draws; ++i) {
    double chi = 0;
    const double truth = mean + sd * normal(engine), z = normal(engine);
    for (int k = 0; k < 4; ++k) chi += std::pow(normal(engine), 2);
    const double measured = truth + u * z / std::sqrt(chi / 4);
    const bool good = std::abs(truth) <= 2, accepted = std::abs(measured) <= 1.5;
    consumer += !good && accepted ? 1 : 0, producer += good && !accepted ? 1 : 0;
  }

  const auto found = global_risks({mean, sd}, {u, 4.0}, {-2.0, 2.0}, {-1.5, 1.5}).value();

  const auto error = [](double p) { return 4 * std::sqrt(p / draws); };
  EXPECT_NEAR(static_cast<double>(consumer) / draws, found.consumer_risk, error(found.consumer_risk));
  EXPECT_NEAR(static_cast<double>(producer) / draws, found.producer_risk, error(found.producer_risk));
}

UncertaintyBudget budget_of(const nlohmann::json& components) {
  UncertaintyBudget budget;
  for (const auto& component : components) {
    BudgetRow row;
    row.name = component["name"], row.value = component["value"];
    if (component["kind"] != "normal") row.distribution = BudgetDistribution::rectangular;
    row.degrees_of_freedom = optional_of(component["degrees_of_freedom"]);
    budget.rows.push_back(row);
  }
  return budget;
}

TEST(Budget, CombinesAsTheReference) {
  for (const auto& reference : test::reference_cases("conformity", "budgets")) {
    const auto found = combined(budget_of(reference["components"]), 1).value();

    EXPECT_NEAR(found.u, reference["combined"], 1e-10);
    EXPECT_NEAR(found.nu_eff.value(), reference["effective_degrees_of_freedom"], 1e-7);
    EXPECT_NEAR(found.k, reference["coverage_factor_95"], 1e-8);
    EXPECT_NEAR(found.expanded_gum, reference["expanded_95"], 1e-9);
    const double monte_carlo = reference["monte_carlo_half_width_95"];
    EXPECT_NEAR(found.expanded_monte_carlo, monte_carlo, 0.01 * monte_carlo);
    EXPECT_EQ(found.expanded, std::max(found.expanded_gum, found.expanded_monte_carlo));
    for (std::size_t i = 0; i < found.shares.size(); ++i)
      EXPECT_NEAR(found.shares[i].share_percent, reference["shares_percent"][i], 1e-6);
  }
}

TEST(Budget, HasTheHalfWidthsOfDistributionsThatAreKnown) {
  struct Known {
    BudgetDistribution distribution;
    double half_width;  // of 95 %, for a value of 1
  };
  // Normal: 1.95996. Rectangle: 0.95. Triangle: 1 - sqrt(0.05). Arcsine: sin(0.95 pi / 2).
  for (const Known& known :
       {Known{BudgetDistribution::normal, 1.959964}, Known{BudgetDistribution::rectangular, 0.95},
        Known{BudgetDistribution::triangular, 0.776393}, Known{BudgetDistribution::u_shaped, 0.996917}}) {
    UncertaintyBudget budget;
    budget.rows.push_back({.name = "one", .value = 3, .distribution = known.distribution, .sensitivity = -0.5});

    const auto found = combined(budget, 7).value();

    // Four standard errors of a quantile from a million draws of the normal distribution, the widest of them.
    EXPECT_NEAR(found.expanded_monte_carlo, 1.5 * known.half_width, 1.5 * known.half_width * 0.004);
    EXPECT_FALSE(found.nu_eff);
  }
}

std::string refusal(const std::string& text) {
  const auto budget = parse_budget(text, "b.toml");
  if (!budget) return budget.error().message;
  const auto found = combined(*budget, 1);
  return found ? "" : found.error().message;
}

TEST(Budget, RefusesNegativeMixedMissingAndDoubledRows) {
  EXPECT_THAT(refusal(""), HasSubstr("no rows"));
  EXPECT_THAT(refusal("[[component]]\nname = 'a'\nvalue = -1\n"), HasSubstr("b.toml:3"));
  EXPECT_THAT(refusal("[[component]]\nname = 'a'\nvalue = nan\n"), HasSubstr("b.toml:3"));
  EXPECT_THAT(refusal("[[component]]\nname = 'a'\nvalue = 0\n"), HasSubstr("all contributions to the budget are 0"));
  EXPECT_THAT(
      refusal("[[component]]\nname = 'a'\nvalue = 1\nunit = 'mm'\n[[component]]\nname = 'b'\nvalue = 1\nunit = 'K'\n"),
      HasSubstr("rows with different units need a sensitivity"));
  EXPECT_THAT(refusal("[[component]]\nname = 'a'\nvalue = 1\nunit = 'mm'\n[[component]]\nname = 'b'\nvalue = 1\n"),
              HasSubstr("rows with different units need a sensitivity"));
  EXPECT_THAT(refusal("unit = '1'\n[[component]]\nname = 'a'\nvalue = 1\nunit = 'mm'\n"), HasSubstr("sensitivity"));
  EXPECT_THAT(refusal("[[component]]\nname = 'a'\nvalue = 1\n[[component]]\nname = 'a'\nvalue = 1\n"),
              HasSubstr("twice"));
  EXPECT_THAT(refusal("[[component]]\nname = 'a'\nvalue = 1\nkind = 'odd'\n"), HasSubstr("rectangular"));
  EXPECT_THAT(refusal("[[component]]\nname = 'a'\nvalue = 1\ncolour = 'red'\n"), HasSubstr("colour"));
  EXPECT_THAT(refusal("[[component]]\nname = 'a'\nvalue = 1\ndegrees_of_freedom = 0\n"),
              HasSubstr("degrees_of_freedom"));
}

TEST(Budget, ReadsEveryKey) {
  const auto budget = parse_budget(R"(quantity = "acuity"
unit = "1"
[[component]]
name = "distance"
value = 4
distribution = "rectangular"
sensitivity = 0.0005
unit = "mm"
source = "tape"
certificate = "K-17"
common = ["twin", "series"]
[[component]]
name = "trials"
value = 0.03
coverage_factor = 2
degrees_of_freedom = 50
unit = "1"
)",
                                   "b.toml")
                          .value();

  ASSERT_EQ(budget.rows.size(), 2u);
  EXPECT_EQ(budget.rows[0].distribution, BudgetDistribution::rectangular);
  EXPECT_THAT(budget.rows[0].common, ::testing::ElementsAre(BudgetCommon::twin, BudgetCommon::series));
  EXPECT_EQ(budget.rows[0].certificate, "K-17");
  const auto found = combined(budget, 1).value();
  EXPECT_NEAR(found.u, std::hypot(0.002 / std::sqrt(3.0), 0.015), 1e-12);
}

}  // namespace
}  // namespace todbench
