// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/observer/answer_probabilities.h"

#include <gmock/gmock.h>

#include <cmath>
#include <vector>

#include "hvs/observer/template_observer.h"
#include "hvs/shape/polygon_image.h"
#include "tests/support/ideal_observer.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

double sinc(double x) {
  return x == 0 ? 1.0 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x);
}

/// A triangle seen by square detectors of full fill factor with white noise, contrast 1 K.
Patch seen(double size, Apex apex, int window, cv::Point2d phase, double noise_k, const RandomStream& noise) {
  const FilterTable filter({.period = 2 * window, .band = 14 * window},
                           [](double u, double w) -> std::complex<double> { return sinc(u) * sinc(w); });
  const double first = -window / 2.0 + 0.5;
  Patch patch{
      .kelvin =
          PolygonImage(triangle(size, apex), filter).sample({first - phase.x, first - phase.y}, 1, {window, window}),
      .phase = phase,
      .noise_k = noise_k};
  std::uint64_t at = 0;
  for (double& value : patch.kelvin) value += noise_k * static_cast<double>(noise.normal(at++));
  return patch;
}

struct Case {
  double size, internal_noise, sensor_noise_factor, noise_k;
};

/// Thirty patches of each: near the threshold, far below it, an observer of limited efficiency, and much noise of its
/// own.
constexpr Case cases[] = {
    {1.6, 0.07, 1, 0.004}, {1.1, 0.07, 1, 0.02}, {2.6, 0.07, 1, 0.3}, {2.6, 0.025, 1.75, 0.3}, {1.6, 0.5, 1, 0.0}};

TEST(AnswerProbabilities, AreTheSharesOfTheAnswersThatTheObserverGives) {
  for (const Case& c : cases) {
    TemplateObserver observer({.internal_noise = c.internal_noise, .sensor_noise_factor = c.sensor_noise_factor},
                              triangle_alternatives());
    const auto prepared = *observer.prepare(c.size, 1);
    double chi_squared = 0;
    int degrees = 0;
    for (std::uint64_t i = 0; i < 30; ++i) {
      const RandomStream stream(5, i);
      const cv::Point2d phase(stream.uniform(1) - 0.5, stream.uniform(2) - 0.5);
      const Patch patch = seen(c.size, all_apexes[i % 4], prepared->window_samples(), phase, c.noise_k, stream.sub(7));
      constexpr int answers = 400, draws = 2000;
      std::array<double, 4> counted{};
      for (std::uint64_t k = 0; k < answers; ++k)
        counted[static_cast<std::size_t>(prepared->choose(patch, 1, stream.sub(8).sub(k)).alternative)] += 1;

      const GradedChoice graded = prepared->judge(patch, 1, stream.sub(9), draws);

      for (std::size_t o = 0; o < 4; ++o) {
        const double p = graded.answers.probability[o];
        // Half an answer for what 400 of them cannot resolve.
        const double variance =
            p * (1 - p) / answers + std::pow(graded.answers.standard_error, 2) + std::pow(0.5 / answers, 2);
        chi_squared += std::pow(counted[o] / answers - p, 2) / variance;
        degrees += p > 0.01 && p < 0.99 ? 1 : 0;
      }
    }
    // Certain answers add nothing; the others about their number, with a scatter of sqrt(2 n) and less for shares that
    // sum to 1. Five of them.
    EXPECT_LT(chi_squared, degrees + 5 * std::sqrt(2.0 * degrees) + 5) << c.size << ' ' << c.internal_noise;
    EXPECT_GE(degrees, 15) << "the case decides nothing";
  }
}

TEST(AnswerProbabilities, SumToOneAndScatterAsTheirStandardErrorSays) {
  TemplateObserver observer({}, triangle_alternatives());
  const auto prepared = *observer.prepare(1.6, 1);
  double squares = 0;
  int uncertain = 0;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const RandomStream stream(6, i);
    const Patch patch = seen(1.6, Apex::up, prepared->window_samples(),
                             {stream.uniform(1) - 0.5, stream.uniform(2) - 0.5}, 0.02, stream.sub(7));

    const GradedChoice few = prepared->judge(patch, 1, stream.sub(8), 32);
    const GradedChoice many = prepared->judge(patch, 1, stream.sub(9), 1600);

    double sum = 0;
    for (const double p : few.answers.probability) sum += p;
    EXPECT_NEAR(sum, 1, 1e-12);
    std::size_t largest = 0;
    for (std::size_t o = 0; o < 4; ++o)
      largest = few.answers.probability[o] > few.answers.probability[largest] ? o : largest;
    if (many.answers.draws == 0 || many.answers.probability[largest] > 0.95) continue;
    ++uncertain;
    squares += std::pow(
        (few.answers.probability[largest] - many.answers.probability[largest]) / few.answers.standard_error, 2);
  }
  ASSERT_GT(uncertain, 60);
  // Variances from four vectors have three degrees of freedom: the mean square of such quotients is 3 in place of 1,
  // its scatter large; a standard error that is told half as large as it is has 12.
  EXPECT_LT(squares / uncertain, 6);
  EXPECT_GT(squares / uncertain, 0.3);
}

TEST(AnswerProbabilities, AreCertainWithoutNoiseAndSharedByEqualAlternatives) {
  TemplateObserver observer({.internal_noise = 0}, triangle_alternatives());
  const auto prepared = *observer.prepare(3, 1);
  const Patch clear = seen(3, Apex::left, prepared->window_samples(), {0.1, 0.3}, 0, RandomStream(1, std::uint64_t{1}));
  const Patch empty{.kelvin = cv::Mat1d(prepared->window_samples(), prepared->window_samples(), 300.0), .phase = {}};

  const GradedChoice certain = prepared->judge(clear, 1, RandomStream(1, std::uint64_t{2}), 32);
  const GradedChoice shared = prepared->judge(empty, 1, RandomStream(1, std::uint64_t{2}), 32);

  EXPECT_EQ(certain.answers.draws, 0);
  EXPECT_EQ(certain.answers.probability[static_cast<std::size_t>(Apex::left)], 1);
  for (std::size_t o = 0; o < 4; ++o) EXPECT_EQ(shared.answers.probability[o], 0.25);
}

TEST(AnswerProbabilities, LeaveTheOneAnswerAsItIs) {
  TemplateObserver observer({}, triangle_alternatives());
  const auto prepared = *observer.prepare(1.3, 1);
  for (std::uint64_t i = 0; i < 50; ++i) {
    const RandomStream stream(2, i);
    const Patch patch = seen(1.3, Apex::down, prepared->window_samples(), {0.2, 0.1}, 0.1, stream.sub(1));

    const Choice one = prepared->choose(patch, 1, stream);
    const GradedChoice graded = prepared->judge(patch, 1, stream, 32);

    EXPECT_EQ(graded.choice.alternative, one.alternative);
    EXPECT_EQ(graded.choice.scores, one.scores);
  }
}

TEST(AnswerProbabilities, OfTheIdealObserverAreThoseOfItsAnswer) {
  IdealObserver observer(
      "ideal", triangle_alternatives(), [](double u, double w) -> std::complex<double> { return sinc(u) * sinc(w); },
      7);
  const auto prepared = *observer.prepare(2, 1);
  const Patch patch = seen(2, Apex::right, prepared->window_samples(), {0, 0}, 0.1, RandomStream(3, std::uint64_t{4}));

  const GradedChoice graded = prepared->judge(patch, 1, RandomStream(3, std::uint64_t{5}), 32);

  EXPECT_EQ(graded.answers.probability[static_cast<std::size_t>(graded.choice.alternative)], 1);
  EXPECT_EQ(graded.answers.draws, 0);
}

}  // namespace
}  // namespace todbench
