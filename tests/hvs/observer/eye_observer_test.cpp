// SPDX-License-Identifier: GPL-3.0-or-later
// The observer with an eye behind a display.
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "acquisition/base/rng.h"
#include "hvs/observer/answer_probabilities.h"
#include "hvs/observer/eye_noise.h"
#include "hvs/observer/known_position.h"
#include "hvs/observer/template_observer.h"
#include "hvs/shape/polygon_image.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

/// A display whose samples are `arcmin`, with a background of 50 cd/m2.
ViewedDisplay display_of(double arcmin) {
  return {.pixel_pitch_mm = 1000 * 2 * std::tan(arcmin / 120 * std::numbers::pi / 180),
          .viewing_distance_m = 1,
          .luminance_white_cd_m2 = 100};
}

TemplateObserverSpec person(double arcmin) {
  return {.name = "hvs-2",
          .internal_noise = 0,
          .sensor_noise_factor = 1.75,
          .eye = EyeParameters{},
          .window_margin_arcmin = 6,
          .display = display_of(arcmin)};
}

/// The ideal target behind the display alone, at contrast 1 K: what a perfect camera shows.
cv::Mat1d ideal_patch(const Polygon& shape, double size, int window) {
  // A box of one sample around every sample's centre, as a detector of full fill factor; periodic far outside.
  const FrequencyLattice lattice{.period = 2 * window, .band = 8 * window};
  const FilterTable filter(lattice, [](double u, double w) -> std::complex<double> {
    const auto sinc = [](double x) { return x == 0 ? 1.0 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x); };
    return sinc(u) * sinc(w);
  });
  const double first = 0.5 - window / 2.0;
  return PolygonImage(placed(shape, size, {0, 0}), filter).sample({first, first}, 1, {window, window});
}

Patch patch_of(const cv::Mat1d& kelvin, double noise_k = 0) {
  return {.kelvin = kelvin, .phase = {0, 0}, .noise_k = noise_k};
}

TEST(EyeNoise, HasTheCovarianceOfAnIntegralOverFrequencies) {
  // Two templates at the places (0, 0) and (5/8, -2/8), by a plain sum over a lattice five times as fine.
  const TemplateObserverSpec spec = person(3);
  const auto bank = TemplateBank::build(spec, triangle_alternatives(), 1.6, 1);
  ASSERT_TRUE(bank.has_value());
  const EyeNoise& eye = *bank->eye();
  const EyeFilter filter(*spec.eye, 50);
  const Polygon up = placed(triangle_alternatives()[0], 1.6, {0, 0});
  const Polygon right = placed(triangle_alternatives()[1], 1.6, {5.0 / 8, -2.0 / 8});
  const double sample_deg = 3.0 / 60;
  double own = 0, between = 0;
  const double step = 1.0 / 120, most = 7;  // cycles per sample
  for (double u = -most; u <= most; u += step) {
    for (double w = 0; w <= most; w += step) {
      const double weight = w == 0 ? 1 : 2;
      const double power =
          filter.identification_power(20 * std::hypot(u, w)) * std::pow(display_transfer(*spec.display, u, w), 2);
      if (power < 1e-6) continue;
      const auto f = polygon_spectrum(up, u, w), g = polygon_spectrum(right, u, w);
      own += weight * power * std::norm(f);
      between += weight * power * (f * std::conj(g)).real();
    }
  }
  own *= step * step * sample_deg * sample_deg;
  between *= step * step * sample_deg * sample_deg;

  const auto centre = static_cast<std::size_t>(bank->central_place());
  const std::size_t moved = 289 + centre + 5 - 2 * 17;

  EXPECT_NEAR(eye.covariance(centre, centre) / own, 1, 1e-6);
  EXPECT_NEAR((eye.covariance(centre, moved) - between) / own, 0, 1e-6);
  EXPECT_NEAR(eye.covariance(centre, moved) / eye.covariance(moved, centre), 1, 1e-12);
}

TEST(EyeNoise, HasDrawsWithItsCovariance) {
  const auto bank = TemplateBank::build(person(3), triangle_alternatives(), 1.6, 1);
  const EyeNoise& eye = *bank->eye();
  RecordProperty("rank", static_cast<int>(eye.rank()));

  EXPECT_LT(eye.rank(), 90U);
  for (const auto& [i, j] : {std::pair(0, 0), std::pair(144, 433), std::pair(3, 1100), std::pair(700, 701)}) {
    double product = 0;
    for (const auto& column : eye.columns())
      product += column[static_cast<std::size_t>(i)] * column[static_cast<std::size_t>(j)];
    // The remainder is positive semidefinite with a diagonal of at most max_left_out.
    EXPECT_NEAR(product, eye.covariance(static_cast<std::size_t>(i), static_cast<std::size_t>(j)) / eye.energy(),
                EyeNoise::max_left_out);
  }
}

TEST(EyeNoise, IsTheSameForAlternativesThatAreTurned) {
  // Without the fourth alternative nothing is known of turns, and every pair has a table of its own.
  Alternatives three = triangle_alternatives();
  three.pop_back();
  const auto all = TemplateBank::build(person(3), triangle_alternatives(), 1.6, 1);
  const auto some = TemplateBank::build(person(3), three, 1.6, 1);
  for (std::size_t i = 0; i < 3 * 289; i += 61) {
    for (std::size_t j = 0; j < 3 * 289; j += 47)
      EXPECT_NEAR(all->eye()->covariance(i, j), some->eye()->covariance(i, j), 1e-9 * all->eye()->energy());
  }
}

TEST(EyeObserver, ScoresAnIdealTargetWithItsEnergy) {
  // At half an arcmin a sample the box of the detectors takes 1 % of what the eye sees.
  const auto bank = TemplateBank::build(person(0.5), triangle_alternatives(), 12, 1);
  ASSERT_TRUE(bank.has_value());
  const cv::Mat1d patch = ideal_patch(triangle_alternatives()[0], 12, bank->window_samples());
  std::vector<float> values(patch.begin(), patch.end()), scores(bank->padded_templates());

  bank->project(values, scores);

  // Score over noise is sqrt(G), without the part of the noise that is in proportion to the contrast c = 0.5.
  const double energy = bank->eye()->energy();
  const double d_prime =
      static_cast<double>(scores[static_cast<std::size_t>(bank->central_place())]) / bank->eye()->sd(1);
  const double expected = 0.5 * std::sqrt(energy) / std::sqrt(1 + std::pow(0.03 * 0.5, 2) * energy);
  EXPECT_NEAR(d_prime / expected, 1, 0.02);
}

TEST(EyeObserver, IgnoresAUniformBackground) {
  TemplateObserver observer(person(3), triangle_alternatives());
  const auto prepared = observer.prepare(3, 1).value();
  const cv::Mat1d shape = ideal_patch(triangle_alternatives()[2], 3, prepared->window_samples());
  const RandomStream noise(1, "test");

  const Choice cold = prepared->choose(patch_of(shape), 1, noise);
  const Choice warm = prepared->choose(patch_of(shape + 300), 1, noise);

  EXPECT_EQ(cold.alternative, 2);
  for (std::size_t o = 0; o < 4; ++o) EXPECT_NEAR(cold.scores[o], warm.scores[o], 1e-4);
}

TEST(EyeObserver, GradesAsOftenAsItAnswers) {
  for (const double noise_k : {0.0, 0.2}) {
    for (const double arcmin : {1.0, 3.0}) {
      TemplateObserverSpec spec = person(arcmin);
      TemplateObserver observer(spec, triangle_alternatives());
      const auto prepared = observer.prepare(1.1, 1).value();
      const Patch patch = patch_of(ideal_patch(triangle_alternatives()[0], 1.1, prepared->window_samples()), noise_k);
      constexpr int trials = 4000;
      const RandomStream stream(3, "test");
      std::array<double, 4> share{};
      for (int t = 0; t < trials; ++t)
        share[static_cast<std::size_t>(
            prepared->choose(patch, 1, stream.sub(static_cast<std::uint64_t>(t))).alternative)] += 1.0 / trials;

      const GradedChoice graded = prepared->judge(patch, 1, stream.sub(99999), 4096);

      for (std::size_t o = 0; o < 4; ++o) {
        const double p = graded.answers.probability[o];
        // Five standard errors of both, and what the draws of low rank may miss.
        const double error = std::sqrt(p * (1 - p) / trials + std::pow(graded.answers.standard_error, 2));
        EXPECT_NEAR(share[o], p, 5 * error + 0.005) << arcmin << ' ' << noise_k << ' ' << o;
      }
    }
  }
}

/// Proportion correct for an ideal target in graded answers, over some places of the search.
double proportion(const TemplateObserverSpec& spec, double size) {
  TemplateObserver observer(spec, triangle_alternatives());
  const auto prepared = observer.prepare(size, 1).value();
  const Patch patch = patch_of(ideal_patch(triangle_alternatives()[0], size, prepared->window_samples()));
  return prepared->judge(patch, 1, RandomStream(5, "test"), 4096).answers.probability[0];
}

TEST(EyeObserver, SeesMoreInMoreLightAtMoreContrastAndFromNearer) {
  TemplateObserverSpec spec = person(1.5);
  double before = 0;
  for (const double white : {1.0, 10.0, 100.0, 1000.0}) {
    spec.display->luminance_white_cd_m2 = white;
    const double now = proportion(spec, 2);
    EXPECT_GT(now, before - 0.01) << white;
    before = now;
  }
  spec = person(1.5);
  before = 0;
  for (const double contrast : {0.02, 0.1, 0.5, 1.0}) {
    spec.display->contrast = contrast;
    const double now = proportion(spec, 2);
    EXPECT_GT(now, before - 0.01) << contrast;
    before = now;
  }
  before = 0;
  for (const double arcmin : {0.5, 1.0, 2.0, 4.0}) {
    const double now = proportion(person(arcmin), 2);
    EXPECT_GT(now, before - 0.01) << arcmin;
    before = now;
  }
}

TEST(EyeObserver, IsLimitedByTheSamplesAloneIfTheEyeIsPerfect) {
  // Sensitivity without bound: no noise is left, and the answer depends neither on the gain nor on the contrast.
  TemplateObserverSpec spec = person(3);
  spec.sensor_noise_factor = 1;
  spec.eye->contrast_noise = 0;
  spec.eye->sensitivity = 1e8;
  const double certain = proportion(spec, 0.7);
  spec.display->contrast = 0.05;

  EXPECT_EQ(proportion(spec, 0.7), certain);
  EXPECT_EQ(certain, 1);
}

TEST(EyeObserver, NeedsADisplayThatFits) {
  TemplateObserverSpec spec = person(3);
  EXPECT_TRUE(validate(spec));
  spec.display->viewing_distance_m = 600;
  EXPECT_FALSE(validate(spec));
  spec = person(3);
  spec.internal_noise = 0.07;
  EXPECT_FALSE(validate(spec));
  EXPECT_FALSE(validate(TemplateObserverSpec{.display = display_of(3)}));
}

}  // namespace
}  // namespace todbench
