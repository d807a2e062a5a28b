// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <cmath>

#include "hvs/observer/known_position.h"
#include "hvs/observer/template_observer.h"
#include "hvs/shape/polygon_image.h"
#include "tests/support/ideal_observer.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

std::complex<double> box(double u, double w) {
  const auto sinc = [](double x) { return x == 0 ? 1.0 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x); };
  return sinc(u) * sinc(w);
}

/// A triangle seen by square detectors of full fill factor, on a background.
Patch clean_patch(double size, Apex apex, int window, cv::Point2d phase, double contrast_k, double background_k) {
  const FilterTable filter({.period = 2 * window, .band = 7 * 2 * window},
                           [](double u, double w) { return box(u, w); });
  const PolygonImage image(triangle(size, apex), filter);
  const double first = -window / 2.0 + 0.5;
  Patch patch;
  patch.kelvin = image.sample({first - phase.x, first - phase.y}, 1, {window, window}) * contrast_k + background_k;
  patch.phase = phase;
  return patch;
}

TEST(TemplateObserver, NamesEveryOrientationOfALargeCleanTriangleAtAnyPhaseAndPolarity) {
  TemplateObserverSpec spec;
  spec.internal_noise = 0;
  TemplateObserver observer(spec, triangle_alternatives());
  const auto prepared = *observer.prepare(4.0, 1);

  for (const Apex apex : all_apexes) {
    for (const double contrast : {16.9, -0.23}) {
      const Patch patch = clean_patch(4.0, apex, prepared->window_samples(), {0.37, -0.21}, contrast, 300);
      const Choice choice = prepared->choose(patch, contrast, RandomStream(1, std::uint64_t{0}));
      EXPECT_EQ(choice.alternative, static_cast<int>(apex));
    }
  }
}

TEST(TemplateObserver, DoesNotSeeTheBackground) {
  TemplateObserver observer({}, triangle_alternatives());
  const auto prepared = *observer.prepare(2.0, 1);
  const RandomStream noise(4, std::uint64_t{9});
  const Patch cold = clean_patch(2.0, Apex::left, prepared->window_samples(), {0.1, 0.2}, 0.001, 0);
  Patch warm = cold;
  warm.kelvin = cold.kelvin + 300.0;

  const Choice a = prepared->choose(cold, 0.001, noise);
  const Choice b = prepared->choose(warm, 0.001, noise);

  EXPECT_EQ(a.alternative, b.alternative);
  // 300 K in double precision leaves 6e-14 K, 6e-11 of a contrast of 1 mK.
  for (std::size_t o = 0; o < 4; ++o) EXPECT_NEAR(a.scores[o], b.scores[o], 1e-6);
}

TEST(TemplateObserver, DecidesTiesByLotAndEvenly) {
  TemplateObserverSpec spec;
  spec.internal_noise = 0;
  TemplateObserver observer(spec, triangle_alternatives());
  const auto prepared = *observer.prepare(2.0, 1);
  Patch flat;
  flat.kelvin = cv::Mat1d(prepared->window_samples(), prepared->window_samples(), 300.0);
  std::array<int, 4> counts{};
  const int n = 4000;

  for (int t = 0; t < n; ++t)
    ++counts[static_cast<std::size_t>(
        prepared->choose(flat, 1, RandomStream(1, std::uint64_t{7}).sub(static_cast<std::uint64_t>(t))).alternative)];

  for (const int count : counts) EXPECT_NEAR(count, n / 4, 4 * std::sqrt(n * 0.25 * 0.75));
}

TEST(TemplateObserver, IsPreparedOncePerSize) {
  TemplateObserver observer({}, triangle_alternatives());

  EXPECT_EQ(*observer.bank(2.0, 1), *observer.bank(2.0, 1));
  EXPECT_NE(*observer.bank(2.0, 1), *observer.bank(2.0, 2));
}

TEST(TemplateObserver, RefusesParametersOutOfRangeByName) {
  TemplateObserverSpec spec;
  spec.search_step_samples = 0.3;

  EXPECT_THAT(validate(spec).error().message, testing::HasSubstr("search_step_samples"));
  EXPECT_TRUE(validate(TemplateObserverSpec{}).has_value());
}

TEST(IdealObserver, IsCorrectAsOftenAsTheOrthantProbabilitySays) {
  const double size = 3.0;
  IdealObserver observer("ideal", triangle_alternatives(), box, 7);
  const auto prepared = *observer.prepare(size, 1);
  const int window = prepared->window_samples();
  const cv::Point2d phase(3 / 16.0, -5 / 16.0);
  const double contrast = 0.23;
  const double sd = 0.12;
  std::vector<Patch> clean;
  for (const Apex apex : all_apexes) clean.push_back(clean_patch(size, apex, window, phase, contrast, 300));
  KnownPositionTask task;
  std::array<double, 4> energy{};
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      const cv::Mat1d a = clean[i].kelvin - cv::mean(clean[i].kelvin)[0];
      const cv::Mat1d b = clean[j].kelvin - cv::mean(clean[j].kelvin)[0];
      task.gram[i][j] = a.dot(b);
    }
    energy[i] = task.gram[i][i];
  }
  for (std::size_t i = 0; i < 4; ++i) task.mean[i] = task.gram[0][i] - energy[i] / 2;
  task.noise = sd;
  const double expected = probability_correct(task, 96);
  const int n = 20'000;
  int correct = 0;
  std::vector<float> noise(static_cast<std::size_t>(window * window));

  for (int t = 0; t < n; ++t) {
    RandomStream(1, "trial").sub(static_cast<std::uint64_t>(t)).fill_normal(noise);
    Patch patch = clean[0];
    patch.kelvin = clean[0].kelvin.clone();
    for (int s = 0; s < window * window; ++s)
      patch.kelvin(s / window, s % window) += sd * static_cast<double>(noise[static_cast<std::size_t>(s)]);
    correct += prepared->choose(patch, contrast, RandomStream(2, std::uint64_t{0})).alternative == 0 ? 1 : 0;
  }

  EXPECT_GT(expected, 0.5);
  EXPECT_LT(expected, 0.95);
  EXPECT_NEAR(static_cast<double>(correct) / n, expected, 4 * std::sqrt(expected * (1 - expected) / n));
}

}  // namespace
}  // namespace todbench
