// SPDX-License-Identifier: GPL-3.0-or-later
// People who are template observers of known parameters, and the patches that they answer.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "hvs/observer/template_observer.h"
#include "hvs/shape/polygon_image.h"
#include "tod/observer_fit/person_fit.h"
#include "tod/plate/test_pattern.h"

namespace todbench::testing {

inline double sinc(double x) {
  return x == 0 ? 1.0 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x);
}

/// A contrast and the sizes shown at it, in samples.
struct ShownContrast {
  double contrast_k = 1;
  std::vector<double> sizes;
};

/// A session like that of the window: square detectors of full fill factor, 0.07 K of noise, sizes about the threshold
/// of each contrast.
inline std::vector<ShownContrast> usual_contrasts() {
  return {{16.9, {0.9, 1.1, 1.3, 1.5, 1.7, 2.0, 2.4, 3.0}},
          {1.93, {0.9, 1.1, 1.3, 1.5, 1.8, 2.1, 2.6, 3.2}},
          {0.23, {1.5, 1.9, 2.3, 2.8, 3.3, 4.0, 4.8, 5.8}}};
}

struct ShownSession {
  std::vector<AnsweredPatch> patches;
  std::vector<int> truths, cells;
};

/// `per_size` patches of each contrast and size, a fourth of each direction, phases at random.
inline ShownSession shown_session(const std::vector<ShownContrast>& contrasts, int per_size, std::uint64_t seed) {
  constexpr double noise_k = 0.07;
  ShownSession out;
  const RandomStream all(seed, "test.people");
  int cell = 0;
  for (const auto& [contrast_k, sizes] : contrasts) {
    for (const double size : sizes) {
      const int half = static_cast<int>(std::ceil(1.05 * size + 2));
      const FilterTable filter({.period = 4 * half, .band = 14 * half},
                               [](double u, double w) -> std::complex<double> { return sinc(u) * sinc(w); });
      for (int k = 0; k < per_size; ++k) {
        const RandomStream own = all.sub(static_cast<std::uint64_t>(out.patches.size()));
        const int truth = k % 4;
        const cv::Point2d phase(own.uniform(1 << 20) - 0.5, own.uniform((1 << 20) + 1) - 0.5);
        const double first = -half + 0.5;
        const cv::Mat1d clean = PolygonImage(triangle(size, all_apexes[static_cast<std::size_t>(truth)]), filter)
                                    .sample({first - phase.x, first - phase.y}, 1, {2 * half, 2 * half});
        AnsweredPatch patch{.kelvin = cv::Mat1f(2 * half, 2 * half),
                            .contrast_k = contrast_k,
                            .noise_k = noise_k,
                            .size_samples = size,
                            .samples_per_pitch = 1};
        std::uint64_t at = 0;
        for (int i = 0; i < clean.rows; ++i) {
          for (int j = 0; j < clean.cols; ++j)
            patch.kelvin(i, j) =
                static_cast<float>(300 + contrast_k * clean(i, j) + noise_k * static_cast<double>(own.normal(at++)));
        }
        out.patches.push_back(std::move(patch));
        out.truths.push_back(truth);
        out.cells.push_back(cell);
      }
      ++cell;
    }
  }
  return out;
}

/// hvs-2 at a display of 3 arcmin a sample with a fixed gain, so that contrasts differ in luminance.
inline TemplateObserverSpec eye_at_display() {
  return {.name = "hvs-2",
          .internal_noise = 0,
          .sensor_noise_factor = 1.75,
          .eye = EyeParameters{},
          .window_margin_arcmin = 6,
          .display = ViewedDisplay{.pixel_pitch_mm = 2000 * std::tan(3.0 / 120 * std::numbers::pi / 180),
                                   .viewing_distance_m = 1,
                                   .luminance_white_cd_m2 = 100,
                                   .span_k = 12}};
}

/// Contrasts and sizes about the threshold for eye_at_display().
inline std::vector<ShownContrast> contrasts_for_an_eye() {
  return {{3, {0.9, 1.1, 1.3, 1.5, 1.7, 2.0, 2.4, 3.0}},
          {1, {1.1, 1.3, 1.6, 1.9, 2.2, 2.6, 3.1, 3.8}},
          {0.35, {1.6, 2.0, 2.5, 3.0, 3.6, 4.3, 5.2, 6.2}}};
}

/// A person with these values.
inline TemplateObserverSpec person_of(const ObserverValues& person, FittedKind kind) {
  if (kind == FittedKind::blurred) {
    return {.name = "person",
            .blur_sigma_samples = person[0],
            .internal_noise = person[1],
            .sensor_noise_factor = person[2]};
  }
  TemplateObserverSpec spec = eye_at_display();
  spec.eye->sensitivity *= person[0];
  spec.eye->contrast_noise = person[1];
  spec.sensor_noise_factor = person[2];
  return spec;
}

/// The answers of an observer with these values: choose() itself, no table of probabilities.
inline std::vector<PersonAnswer> answers_of(const ObserverValues& person, const ShownSession& session,
                                            std::uint64_t seed, FittedKind kind = FittedKind::blurred) {
  TemplateObserver observer(person_of(person, kind), triangle_alternatives());
  std::vector<PersonAnswer> out;
  const RandomStream all(seed, "test.answers");
  for (std::size_t i = 0; i < session.patches.size(); ++i) {
    const AnsweredPatch& shown = session.patches[i];
    const auto prepared = *observer.prepare(shown.size_samples, shown.samples_per_pitch);
    const Patch patch{.kelvin = cv::Mat1d(shown.kelvin), .phase = {}, .noise_k = shown.noise_k};
    const RandomStream own = all.sub(i);
    int answer = prepared->choose(patch, shown.contrast_k, own).alternative;
    if (own.sub(9).uniform(0) < person[3]) answer = static_cast<int>(own.sub(9).below(4, 1));
    out.push_back({.patch = i, .answer = answer, .truth = session.truths[i], .cell = session.cells[i]});
  }
  return out;
}

}  // namespace todbench::testing
