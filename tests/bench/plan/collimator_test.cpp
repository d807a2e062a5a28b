// SPDX-License-Identifier: GPL-3.0-or-later
// Plans with a collimator.
#include "bench/plan/collimator.h"

#include <gmock/gmock.h>

#include <cmath>

#include "bench/plan/instrument_description.h"
#include "bench/plan/loaded_plan.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;

constexpr SpectralBand long_wave{7.5, 13};

Result<LoadedPlan> plan_with(const std::string& target, const std::string& more = "") {
  return read_plan({.origin = "p.toml",
                    .text = "[target]\nplates = [\"tcat-a\"]\ndelta_t_k = [16.9, 1.93]\n" + target + "\n" + more},
                   "");
}

const BudgetRow* row_named(const Plan& plan, std::string_view name) {
  for (const BudgetRow& row : plan.uncertainty.rows)
    if (row.name == name) return &row;
  return nullptr;
}

TEST(Collimator, ReplacesTheDistanceByItsFocalLength) {
  const auto loaded = plan_with("collimator = { focal_length_mm = 1500, transmission = 0.9 }");

  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_DOUBLE_EQ(loaded->plan().target.distance_m, 1.5);
}

TEST(Collimator, InMetresIsRefusedWithItsUnit) {
  const auto in_metres = plan_with("collimator = { focal_length_mm = 1.5 }");

  ASSERT_FALSE(in_metres);
  EXPECT_THAT(in_metres.error().message, HasSubstr("a number from 10 to 100000, found 1.5; is the value in m?"));
}

TEST(Collimator, AndADistanceTogetherAreRejected) {
  const auto both = plan_with("distance_m = 1.5\ncollimator = { focal_length_mm = 1500 }");
  const auto neither = plan_with("");
  const auto no_length = plan_with("distance_m = 2\ncollimator = { transmission = 0.9 }");

  ASSERT_FALSE(both);
  EXPECT_EQ(both.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(both.error().message, HasSubstr("states a distance and a collimator"));
  ASSERT_FALSE(neither);
  EXPECT_THAT(neither.error().message, HasSubstr("distance_m"));
  ASSERT_FALSE(no_length);
  EXPECT_THAT(no_length.error().message, HasSubstr("focal length"));
}

TEST(Collimator, IsWrittenWithTheResolvedPlan) {
  const auto loaded = plan_with(
      "collimator = { focal_length_mm = 2000, focal_length_u_mm = 2, transmission = 0.92, transmission_u = 0.01, "
      "mirror_temperature_c = 22, blur_mrad = 0.05 }",
      "[[uncertainty.component]]\nname = \"camera scale\"\nvalue = 1\nunit = \"%\"\n");
  ASSERT_TRUE(loaded) << loaded.error().message;

  const auto again = parse_plan({.origin = "again.toml", .text = to_toml(loaded->plan())}, "");

  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(*again, loaded->plan());
  EXPECT_THAT(to_toml(loaded->plan()), ::testing::Not(HasSubstr("distance_m")));
}

TEST(Collimator, AveragesATableOfTransmissions) {
  // A line through the band: its mean lies at the mean wavelength of the weights.
  CollimatorPlan collimator{.focal_length_mm = 1000, .wavelengths_um = {7.5, 13}, .transmissions = {0.75, 1.3 * 0.75}};
  double sum = 0, weights = 0;
  for (int i = 0; i < 100000; ++i) {
    const double wavelength = 7.5 + 5.5 * (i + 0.5) / 100000;
    sum += thermal_weight(wavelength, 295) * std::lerp(0.75, 0.975, (wavelength - 7.5) / 5.5);
    weights += thermal_weight(wavelength, 295);
  }

  EXPECT_NEAR(mean_transmission(collimator, long_wave), sum / weights, 1e-5);

  collimator.transmissions = {0.8, 0.8};
  EXPECT_NEAR(mean_transmission(collimator, long_wave), 0.8, 1e-12);
}

TEST(Collimator, PassesItsTransmissionOfAContrast) {
  auto loaded = plan_with("collimator = { focal_length_mm = 1000, transmission = 0.9, mirror_temperature_c = 21.85 }");
  ASSERT_TRUE(loaded) << loaded.error().message;
  const Plan& plan = loaded->plan();

  // Mirrors at the temperature of the surround: the contrast times the transmission, up to the curvature of Planck's
  // law, of 1 % a kelvin: 0.9 x 0.1 K (1 + 0.01 / 2 x 0.1 x 0.1).
  const double contrast = seen_through_k(plan, long_wave, 295.1) - seen_through_k(plan, long_wave, 295);
  EXPECT_NEAR(seen_through_k(plan, long_wave, 295), 295, 1e-9);
  EXPECT_NEAR(contrast, 0.09, 1e-5);
}

TEST(Collimator, GivesRowsToTheBudget) {
  const auto loaded = plan_with(
      "air_temperature_c = 22\ncollimator = { focal_length_mm = 2000, focal_length_u_mm = 4, transmission = 0.8, "
      "transmission_u = 0.016, mirror_temperature_c = 32, blur_mrad = 0.1 }",
      "[camera]\nid = \"sim:sc2000\"\nifov_mrad = 1.3085\n"
      "[[uncertainty.component]]\nname = \"camera scale\"\nvalue = 1\nunit = \"%\"\n");
  ASSERT_TRUE(loaded) << loaded.error().message;
  const Plan& plan = loaded->plan();

  const BudgetRow* const focal = row_named(plan, focal_length_row);
  const BudgetRow* const transmission = row_named(plan, transmission_row);
  const BudgetRow* const mirrors = row_named(plan, mirrors_row);
  const BudgetRow* const aberration = row_named(plan, aberration_row);

  ASSERT_TRUE(focal && transmission && mirrors && aberration);
  EXPECT_DOUBLE_EQ(focal->value, 4);
  EXPECT_NEAR(relative_u_of_distance(plan), 0.002, 1e-9);
  EXPECT_NEAR(transmission->value, 0.02, 1e-12);
  // The picture of the surround is 0.2 x 10 K = 2 K warmer; d ln(dL/dT) / dT by differences.
  const double seen_k = seen_through_k(plan, long_wave, 295.15);
  EXPECT_NEAR(seen_k - 295.15, 2.1, 0.2);
  const double slope =
      (std::log(band_radiance_derivative(long_wave, 296.15)) - std::log(band_radiance_derivative(long_wave, 294.15))) /
      2;
  EXPECT_NEAR(mirrors->value, slope * (seen_k - 295.15), 5e-4);
  EXPECT_NEAR(aberration->value, std::sqrt(1 + 12 * std::pow(0.1 / 1.3085, 2)) - 1, 1e-12);
  EXPECT_THAT(not_stated(plan.uncertainty), ::testing::Not(::testing::Contains(BudgetInput::entrance_pupil)));
  EXPECT_THAT(not_stated(plan.uncertainty), ::testing::Not(::testing::Contains(BudgetInput::distance)));
}

TEST(WarmUpKeys, AreReadAndWritten) {
  const auto loaded = read_plan({.origin = "p.toml",
                                 .text = "[camera]\nwarm_up = { time_s = 30, drift_k_per_min = 0.05 }\n"
                                         "[target]\ndistance_m = 2\n"},
                                "");

  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->plan().camera.warm_up.time_s, 30);
  const auto again = parse_plan({.origin = "again.toml", .text = to_toml(loaded->plan())}, "");
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(*again, loaded->plan());
  EXPECT_THAT(to_toml(Plan{}), ::testing::Not(HasSubstr("warm_up")));
}

TEST(AbsoluteTemperatures, NeedABlackBodyAndThreeTemperatures) {
  const auto scene = plan_with("distance_m = 2", "[measures]\nabsolute = true\n");
  const auto few = plan_with("distance_m = 2\nkind = \"scpi\"\nblack_body = \"a:1\"\nstage = \"a:2\"",
                             "[measures]\nabsolute = true\nabsolute_temperatures_k = [290, 300]\n");

  ASSERT_FALSE(scene);
  EXPECT_THAT(scene.error().message, HasSubstr("absolute set-point"));
  ASSERT_FALSE(few);
  EXPECT_THAT(few.error().message, HasSubstr("at least three"));
}

TEST(AbsoluteSetPoint, IsReadFromTheTableOfABlackBody) {
  const auto shipped = load_instrument("scpi-black-body");
  ASSERT_TRUE(shipped) << shipped.error().message;
  ASSERT_TRUE(shipped->black_body.absolute);
  EXPECT_EQ(shipped->black_body.absolute->set, "SOUR:TEMP:ABS {}");

  const std::string table =
      "kind = \"black_body\"\ndescription = \"d\"\n[difference]\nunit = \"K\"\nset = \"D {}\"\nmeasured = \"D?\"\n"
      "range = [-10, 10]\ntolerance = 0.01\n[settled]\ndwell_s = 1\n[temperatures]\nunit = \"degC\"\n";
  const auto celsius = parse_instrument(
      {.origin = "t.toml", .text = table + "radiator = \"T?\"\nset = \"T {}\"\nrange = [10, 40]\ntolerance = 0.01\n"});
  const auto blind = parse_instrument({.origin = "t.toml", .text = table + "set = \"T {}\"\nrange = [10, 40]\n"});

  ASSERT_TRUE(celsius) << celsius.error().message;
  EXPECT_NEAR(celsius->black_body.absolute->limits_k[0], 283.15, 1e-9);
  EXPECT_NEAR(celsius->black_body.absolute->tolerance_k, 0.01, 1e-12);
  ASSERT_FALSE(blind);
  EXPECT_THAT(blind.error().message, HasSubstr("radiator"));
}

}  // namespace
}  // namespace todbench
