// SPDX-License-Identifier: GPL-3.0-or-later
// Contrasts measured in several set-ups before the same detectors.
#include "tod/measurement/contrast_error.h"

#include <gmock/gmock.h>

#include <cmath>
#include <vector>

#include "acquisition/base/distributions.h"
#include "acquisition/base/rng.h"
#include "tod/psychometric/contrast_slope.h"

namespace todbench {
namespace {

using ::testing::DoubleNear;

/// What makes the contrasts of triangles differ, standard deviations in kelvin.
struct Scatter {
  double place_k = 0;   ///< of the detectors there: the same in every set-up
  double noise_k = 0;   ///< of each triangle in each set-up
  double set_up_k = 0;  ///< of all triangles of a set-up
};

constexpr double truth_k = 0.23;

/// As the shipped plates hang: two plates in four mountings, four large triangles each, at the top in half of the
/// set-ups and at the bottom in the others; those of the second plate are 0.3 px beside those of the first.
std::vector<ContrastMeasurement> measured(const Scatter& scatter, std::uint64_t seed) {
  const RandomStream stream(seed, "contrasts");
  std::uint64_t draw = 0;
  std::vector<double> of_place;
  for (int place = 0; place < 8; ++place) of_place.push_back(scatter.place_k * stream.normal(draw++));
  std::vector<ContrastMeasurement> out;
  for (int set_up = 0; set_up < 8; ++set_up) {
    const bool second_plate = set_up >= 4, bottom = set_up % 2 == 1;
    const double common = scatter.set_up_k * stream.normal(draw++);
    ContrastMeasurement one;
    one.set_delta_t_k = truth_k;
    for (int column = 0; column < 4; ++column) {
      const int place = column + (bottom ? 4 : 0);
      one.references.push_back({.value = truth_k + common + of_place[static_cast<std::size_t>(place)] +
                                         scatter.noise_k * stream.normal(draw++),
                                .place_px = {100 + 18.7 * column + (second_plate ? 0.3 : 0), bottom ? 205.0 : 120.0},
                                .size_px = second_plate ? 4.3 : 5.2});
      one.delta_t_k += one.references.back().value / 4;
    }
    out.push_back(one);
  }
  return out;
}

struct Coverage {
  double stated = 0, of_set_ups_alone = 0, variance_ratio = 0;
};

Coverage coverage(const Scatter& scatter, int draws) {
  Coverage out;
  double stated = 0, actual = 0;
  for (int k = 0; k < draws; ++k) {
    const auto measurements = measured(scatter, static_cast<std::uint64_t>(k));
    double mean = 0, squares = 0;
    for (const auto& one : measurements) mean += one.delta_t_k / 8;
    for (const auto& one : measurements) squares += std::pow(one.delta_t_k - mean, 2);
    const auto error = contrast_error(measurements);
    const double t = distribution::quantile_above(0.025, error->degrees_of_freedom);
    const double t7 = distribution::quantile_above(0.025, 7);
    out.stated += std::abs(mean - truth_k) <= t * error->standard_error_k ? 1.0 / draws : 0;
    out.of_set_ups_alone += std::abs(mean - truth_k) <= t7 * std::sqrt(squares / 7 / 8) ? 1.0 / draws : 0;
    stated += std::pow(error->standard_error_k, 2) / draws;
    actual += std::pow(mean - truth_k, 2) / draws;
  }
  out.variance_ratio = stated / actual;
  return out;
}

TEST(ContrastError, HoldsTheTruthWhereSetUpsLookAtTheSameDetectors) {
  // 2000 draws: the standard error of a share near 0.95 is 0.005.
  const Coverage pattern = coverage({.place_k = 0.02, .noise_k = 0.01}, 2000);
  EXPECT_GT(pattern.stated, 0.93);
  EXPECT_LT(pattern.stated, 0.985);
  EXPECT_THAT(pattern.variance_ratio, DoubleNear(1.05, 0.15));
  // Over set-ups alone it would be less than half of what it is.
  EXPECT_LT(pattern.of_set_ups_alone, 0.75);
}

TEST(ContrastError, HoldsTheTruthWhereNoiseOrTheSetUpDecides) {
  for (const Scatter& scatter : {Scatter{.noise_k = 0.01}, Scatter{.noise_k = 0.003, .set_up_k = 0.01},
                                 Scatter{.place_k = 0.01, .noise_k = 0.005, .set_up_k = 0.005}}) {
    const Coverage found = coverage(scatter, 2000);
    EXPECT_GT(found.stated, 0.93) << scatter.place_k << " " << scatter.noise_k << " " << scatter.set_up_k;
    EXPECT_LT(found.stated, 0.99) << scatter.place_k << " " << scatter.noise_k << " " << scatter.set_up_k;
    EXPECT_LT(found.variance_ratio, 1.6) << scatter.place_k << " " << scatter.noise_k << " " << scatter.set_up_k;
  }
}

TEST(ContrastError, OfOneMeasurementIsTheScatterOfItsTriangles) {
  const auto all = measured({.noise_k = 0.01}, 5);
  const ContrastMeasurement& one = all.front();
  double squares = 0;
  for (const ReferenceTriangle& triangle : one.references) squares += std::pow(triangle.value - one.delta_t_k, 2);

  const auto error = contrast_error(std::span(all).first(1));

  ASSERT_TRUE(error);
  EXPECT_NEAR(error->standard_error_k, std::sqrt(squares / 3 / 4), 1e-15);
  EXPECT_EQ(error->shared_k, error->standard_error_k);  // there is no scatter over set-ups
  EXPECT_EQ(error->degrees_of_freedom, 3);

  // One triangle in one set-up says nothing, in two their difference.
  ContrastMeasurement single = one;
  single.references.resize(1);
  single.delta_t_k = 0.22;
  single.references[0].value = 0.22;
  EXPECT_FALSE(contrast_error(std::span(&single, 1)));
  std::vector<ContrastMeasurement> two{single, single};
  two[1].delta_t_k = two[1].references[0].value = 0.24;
  ASSERT_TRUE(contrast_error(two));
  EXPECT_NEAR(contrast_error(two)->standard_error_k, 0.01, 1e-15);
  EXPECT_EQ(contrast_error(two)->shared_k, 0);
  EXPECT_EQ(contrast_error(two)->degrees_of_freedom, 1);
}

TEST(ContrastError, IsGivenToTheContrastsItIsOf) {
  TodCurve curve;
  curve.points.resize(2);
  curve.points[0].set_delta_t_k = 1.93;
  curve.points[0].delta_t_measurements = 3;
  curve.points[0].delta_t_se_k = 0.5;
  curve.points[1].set_delta_t_k = truth_k;
  curve.points[1].delta_t_k = truth_k;
  curve.points[1].delta_t_measurements = 1;
  const auto all = measured({.noise_k = 0.01}, 5);
  EXPECT_TRUE(has_contrast_measured_once(curve));

  add_contrast_errors(curve, std::span(all).first(1));

  EXPECT_FALSE(has_contrast_measured_once(curve));
  EXPECT_EQ(contrast_se_k(curve.points[0]), 0.5);
  EXPECT_EQ(freedom_of_contrast(curve.points[0]), 2);
  EXPECT_EQ(contrast_se_k(curve.points[1]), contrast_error(std::span(all).first(1))->standard_error_k);
  EXPECT_EQ(freedom_of_contrast(curve.points[1]), 3);
}

}  // namespace
}  // namespace todbench
