// SPDX-License-Identifier: GPL-3.0-or-later
// The observer where noise vanishes or rules, where scores are equal, and where its decision variables are nearly one.
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <numbers>

#include "hvs/observer/known_position.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/sensor/image_chain.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

KnownPositionTask equicorrelated(double correlation, double signal, double noise) {
  KnownPositionTask task;
  task.mean = {signal, 0, 0, 0};
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) task.gram[i][j] = i == j ? 1 : correlation;
  }
  task.noise = noise;
  return task;
}

/// P of four variables with one common part: the common part drops out of the comparison, so that the answer is that of
/// independent ones at d = signal / (noise sqrt(1 - correlation)): integral of phi(x - d) Phi(x)^3.
double one_dimensional(double d) {
  const auto integrand = [d](double x) {
    const double phi = std::exp(-(x - d) * (x - d) / 2) / std::sqrt(2 * std::numbers::pi);
    return phi * std::pow(0.5 * std::erfc(-x / std::numbers::sqrt2), 3);
  };
  return boost::math::quadrature::gauss_kronrod<double, 61>::integrate(integrand, d - 12, d + 12, 12, 1e-13);
}

// Hard: the covariance of the differences is 1 - correlation of its parts: at 1 - 1e-12 all but four digits cancel.
TEST(ObserverExtremes, OrthantProbabilitiesKeepTheirAccuracyUpToCorrelationOne) {
  for (const double gap : {0.5, 1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12}) {
    for (const double d : {0.0, 0.3, 1.6828, 4.0}) {
      const double correlation = 1 - gap, exact_gap = 1 - correlation;
      const double noise = 1, signal = d * noise * std::sqrt(exact_gap);

      const double found = probability_correct(equicorrelated(correlation, signal, noise), 96);

      // The rule's own error at 96 nodes is 8e-6; the double 1 - gap is exact, its differences too.
      EXPECT_NEAR(found, one_dimensional(d), 1e-5) << gap << " " << d;
    }
  }
}

// Hard: singular covariance: two, three or all alternatives are the same variable.
TEST(ObserverExtremes, IdenticalAlternativesGiveProbabilitiesAndNoNaN) {
  KnownPositionTask task = equicorrelated(1, 0, 1);
  EXPECT_NEAR(probability_correct(task, 32), 0.25, 0.25);  // a probability, whatever the lot does
  task.mean = {1e-3, 0, 0, 0};
  EXPECT_NEAR(probability_correct(task, 32), 1, 1e-12);
  task.mean = {-1e-3, 0, 0, 0};
  EXPECT_NEAR(probability_correct(task, 32), 0, 1e-12);
}

// Hard: d = signal / noise runs from overflow to nothing.
TEST(ObserverExtremes, NoiseFromNothingToAThousandTimesTheSignalMovesFromCertaintyToChance) {
  double before = 1.1;
  for (const double noise : {0.0, 1e-300, 1e-12, 1e-3, 0.1, 0.3, 1.0, 10.0, 1e3, 1e12, 1e300}) {
    const double p = probability_correct(equicorrelated(0.9, 1, noise), 64);

    EXPECT_GE(p, 0.25 - 1e-5) << noise;
    EXPECT_LE(p, before + 1e-12) << noise;
    before = std::min(p, 1.0);
    if (noise <= 1e-3) {
      EXPECT_NEAR(p, 1, 1e-13) << noise;  // weights of the rule sum to 1 within rounding
    }
    if (noise >= 1e3) {
      // d = 1 / (noise sqrt(0.1)): P - 1/4 = d * 3 * integral of phi^2 Phi^2 < 0.3 d.
      EXPECT_NEAR(p, 0.25, 0.3 / (noise * std::sqrt(0.1)) + 1e-5);
    }
  }
}

Patch degraded(const Polygon& shape, int window, double contrast_k, double background_k) {
  const SensorSpec spec;
  const ImageChain chain(spec, full_plan(spec, {}, {}), Accuracy::normal());
  const double first = -window / 2.0 + 0.5;
  Patch patch;
  patch.kelvin = chain.image(shape).sample({first, first}, 1, {window, window}) * contrast_k + background_k;
  return patch;
}

// Hard: 1 mK on 300 K is 3e-6 of the number: single precision holds 3e-5 K there, a thirtieth of the contrast, and the
// noise of a sum over a patch would drown it. In double precision the answer must not see the background.
TEST(ObserverExtremes, AMillikelvinOnThreeHundredKelvinIsJudgedAsOnNothing) {
  TemplateObserverSpec spec;
  spec.internal_noise = 0;
  TemplateObserver observer(spec, triangle_alternatives());
  const auto prepared = *observer.prepare(3.0, 1);
  for (const Apex apex : all_apexes) {
    const Patch on_nothing = degraded(triangle(3, apex, {0.2, 0.3}), prepared->window_samples(), 1e-3, 0);
    const Patch on_room = degraded(triangle(3, apex, {0.2, 0.3}), prepared->window_samples(), 1e-3, 300);
    // What a single-precision picture would hold; rounding adds 1e-5 K rms, a hundredth of the contrast per sample.
    Patch single = on_room;
    single.kelvin = on_room.kelvin.clone();
    for (double& value : single.kelvin) value = static_cast<double>(static_cast<float>(value));

    const Choice a = prepared->choose(on_nothing, 1e-3, RandomStream(1, "a"));
    const Choice b = prepared->choose(on_room, 1e-3, RandomStream(1, "a"));
    const Choice c = prepared->choose(single, 1e-3, RandomStream(1, "a"));

    EXPECT_EQ(a.alternative, static_cast<int>(apex));
    EXPECT_EQ(b.alternative, static_cast<int>(apex));
    EXPECT_EQ(c.alternative, static_cast<int>(apex));
    for (std::size_t o = 0; o < 4; ++o) {
      // 300 K in double precision: 6e-14 K, 6e-11 of the contrast, summed over 150 samples; scores are single
      // precision.
      EXPECT_NEAR(a.scores[o], b.scores[o], 1e-6 * std::max(1.0, std::abs(a.scores[o])));
      // Spacing of floats at 300: 3.05e-5 K, so 8.8e-6 K rms, 8.8e-3 of the contrast; a unit-norm template passes that
      // sd; six of them, and the mean that the template does not see.
      EXPECT_NEAR(a.scores[o], c.scores[o], 6 * 8.8e-3);
    }
  }
}

// Hard: noise a thousand times the signal, and its scores 1e6 times the smallest differences. Answers must be even.
TEST(ObserverExtremes, NoiseAThousandTimesTheSignalIsAnsweredByChance) {
  TemplateObserver observer({}, triangle_alternatives());
  const auto prepared = *observer.prepare(2.0, 1);
  const int window = prepared->window_samples();
  const Patch clean = degraded(triangle(2, Apex::up), window, 1, 300);
  constexpr int trials = 2000;
  int correct = 0;
  std::vector<float> noise(static_cast<std::size_t>(window) * static_cast<std::size_t>(window));
  for (int i = 0; i < trials; ++i) {
    const RandomStream stream = RandomStream(3, "extreme").sub(static_cast<std::uint64_t>(i));
    stream.sub(0).fill_normal(noise);
    Patch patch = clean;
    patch.kelvin = clean.kelvin.clone();
    for (std::size_t k = 0; k < noise.size(); ++k)
      patch.kelvin(static_cast<int>(k) / window, static_cast<int>(k) % window) +=
          1000.0 * static_cast<double>(noise[k]);

    const Choice choice = prepared->choose(patch, 1, stream.sub(1));

    for (std::size_t o = 0; o < 4; ++o) ASSERT_TRUE(std::isfinite(choice.scores[o]));
    correct += choice.alternative == static_cast<int>(Apex::up) ? 1 : 0;
  }
  // Binomial, sd sqrt(n 3/16); the maxima over places of four alternatives are alike by symmetry of square and noise,
  // up and down, left and right; the two pairs differ by the grid of the search only: 2 %.
  EXPECT_NEAR(correct / static_cast<double>(trials), 0.25, 4 * std::sqrt(3.0 / 16 / trials) + 0.02);
}

// Hard: all scores equal. A rule that takes the first maximum would answer "up" for ever and report a wrong threshold.
TEST(ObserverExtremes, EqualScoresAreDecidedByLotAtEveryLevel) {
  TemplateObserverSpec spec;
  spec.internal_noise = 0;
  TemplateObserver observer(spec, triangle_alternatives());
  const auto prepared = *observer.prepare(2.0, 1);
  for (const double level : {0.0, 300.0, 1e-300, 1e6}) {
    Patch flat;
    flat.kelvin = cv::Mat1d(prepared->window_samples(), prepared->window_samples(), level);
    std::array<int, 4> counts{};
    constexpr int trials = 2000;

    for (int i = 0; i < trials; ++i) {
      const auto stream = RandomStream(5, "ties").sub(static_cast<std::uint64_t>(i));
      ++counts[static_cast<std::size_t>(prepared->choose(flat, 1, stream).alternative)];
    }

    for (const int count : counts) EXPECT_NEAR(count, trials / 4.0, 4.5 * std::sqrt(trials * 3.0 / 16)) << level;
  }
}

// Hard: windows beyond memory. A refusal in words, not an allocation that fails.
TEST(ObserverExtremes, SizesFromAHundredthToFiveHundredSamplesArePreparedOrRefusedInWords) {
  TemplateObserver observer({}, triangle_alternatives());
  for (const double size : {0.01, 0.1, 1.0, 20.0}) EXPECT_TRUE(observer.prepare(size, 1)) << size;

  const auto huge = observer.prepare(500, 1);

  ASSERT_FALSE(huge);
  EXPECT_EQ(huge.error().code, ErrorCode::invalid_input);
  EXPECT_FALSE(huge.error().message.empty());
}

}  // namespace
}  // namespace todbench
