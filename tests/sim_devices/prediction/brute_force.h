// SPDX-License-Identifier: GPL-3.0-or-later
// The 75 % size by trials on frames of the simulated camera, for comparison with the estimate without frames.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <vector>

#include "hvs/observer/template_observer.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tests/sim_devices/reference.h"
#include "tod/plate/test_pattern.h"
#include "tod/registration/patch_windows.h"

namespace todbench::test {

struct ThresholdByTrials {
  double s75_pitch = 0, standard_error_pitch = 0;
};

struct Trials {
  double correct = 0, squares = 0;  ///< of the places: sums of their shares of correct answers, and of the squares
  int places = 0;
  [[nodiscard]] double mean() const { return correct / places; }
  /// Of the mean. Without much noise the frames of a place tell little more than one.
  [[nodiscard]] double variance() const { return (squares / places - mean() * mean()) / (places - 1); }
};

/// Triangles of one size side by side, each at a sampling phase of its own.
inline PlateScene scene_of_one_size(const SensorSpec& spec, double size_pitch, double delta_t_k,
                                    const RandomStream& stream) {
  PlateScene scene;
  scene.delta_t_k = delta_t_k;
  scene.distance_m = 1;
  scene.background_k = spec.scene_temperature_k;
  // Windows reach 1.05 sizes and two pitches and a search from the centre, and see no neighbour.
  const double cell = 2 * size_pitch + 8.4;
  for (double y = cell; y < spec.height - cell; y += cell) {
    for (double x = cell; x < spec.width - cell; x += cell) {
      const std::size_t t = scene.plate.triangles.size();
      const cv::Point2d moved(stream.uniform(2 * t) - 0.5, stream.uniform(2 * t + 1) - 0.5);
      const cv::Point2d place = cv::Point2d(x, y) + moved - 0.5 * cv::Point2d(spec.width, spec.height);
      scene.plate.triangles.push_back({.name = std::to_string(t),
                                       .position_mm = place * spec.ifov_mrad(),
                                       .size_mm = size_pitch * spec.ifov_mrad(),
                                       .apex = all_apexes[t % 4]});
    }
  }
  return scene;
}

/// At one size, on four frames of each of so many scenes: every frame is rounded and clipped by the camera.
inline Trials trials_of(const SensorSpec& spec, const TemplateObserverSpec& observer, double size_pitch, double scene_k,
                        double seen_k, int scenes, std::uint64_t seed) {
  constexpr int frames = 4;
  const SensorModel model(spec, full_plan(spec, {}, {}), Accuracy::normal(), seed);
  TemplateObserver own(observer, triangle_alternatives());
  const auto prepared = own.prepare(size_pitch, 1);
  EXPECT_TRUE(prepared);
  Trials trials;
  for (int s = 0; s < scenes; ++s) {
    const RandomStream stream = RandomStream(seed, "brute force").sub(static_cast<std::uint64_t>(s));
    const PlateScene scene = scene_of_one_size(spec, size_pitch, scene_k, stream);
    std::vector<double> correct(scene.plate.triangles.size(), 0.0);
    for (int frame = 0; frame < frames; ++frame) {
      const auto index = static_cast<std::uint64_t>(s * frames + frame);
      const cv::Mat1w counts = model.expose(scene, index);
      for (std::size_t t = 0; t < correct.size(); ++t) {
        const auto& triangle = scene.plate.triangles[t];
        const PatchWindow window = patch_window(
            scene_pixel(scene, triangle.position_mm, spec.ifov_mrad(), model.size()), (*prepared)->window_samples());
        Patch patch;
        counts(window.pixels)
            .convertTo(patch.kelvin, CV_64F, spec.kelvin_per_count, spec.offset_k - spec.scene_temperature_k);
        patch.phase = window.phase;
        const Choice choice = (*prepared)->choose(patch, seen_k, stream.sub(1000 + index).sub(t));
        correct[t] += choice.alternative == static_cast<int>(triangle.apex) ? 1.0 / frames : 0;
      }
    }
    for (const double share : correct) {
      trials.correct += share;
      trials.squares += share * share;
      ++trials.places;
    }
  }
  return trials;
}

/// At the sizes of a direct estimate, with its interpolation: a weighted quadratic of ln((P - 0.25) / (1 - P)) in ln S.
inline ThresholdByTrials threshold_by_trials(const SensorSpec& spec, const TemplateObserver& observer,
                                             const DirectPoint& direct, double scene_k, int scenes,
                                             std::uint64_t seed) {
  const double middle = direct.sizes_pitch[2];
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < direct.sizes_pitch.size(); ++i) {
    const double size = direct.sizes_pitch[i];
    const Trials trials =
        trials_of(spec, observer.spec(), size, scene_k, direct.seen_delta_t_k, scenes, seed + 1000 * i);
    const double inside = std::min(std::max(trials.mean(), 0.25 + 0.5 / trials.places), 1 - 0.5 / trials.places);
    const double slope = 1 / (inside - 0.25) + 1 / (1 - inside);
    const double weight = 1 / (std::max(trials.variance(), 1e-8) * slope * slope);
    const double x = std::log(size / middle);
    const Eigen::Vector3d row(1, x, x * x);
    normal += weight * row * row.transpose();
    right += weight * row * std::log((inside - 0.25) / (1 - inside));
  }
  const Eigen::Matrix3d covariance = normal.inverse();
  const Eigen::Vector3d c = covariance * right;
  double x = 0;
  for (int i = 0; i < 50; ++i) x -= (c(0) + c(1) * x + c(2) * x * x - std::numbers::ln2) / (c(1) + 2 * c(2) * x);
  const Eigen::Vector3d at(1, x, x * x);
  const double s75 = middle * std::exp(x);
  return {s75, s75 * std::sqrt(at.dot(covariance * at)) / std::abs(c(1) + 2 * c(2) * x)};
}

/// The sc2000 with so much noise, in counts, and a contrast in counts.
struct RoundedCase {
  double noise_counts = 1, contrast_counts = 1;
};

inline SensorSpec rounded_sensor(double noise_counts) {
  SensorSpec spec = sc2000();
  spec.kelvin_per_count = 0.1;
  spec.netd_k = noise_counts * spec.kelvin_per_count;
  return spec;
}

/// The claim of the estimate: 1 % and three standard errors.
inline void expect_estimate_is_what_trials_say(const RoundedCase& rounded, TemplateObserver& observer, int scenes) {
  const SensorSpec spec = rounded_sensor(rounded.noise_counts);
  const double contrast_k = rounded.contrast_counts * spec.kelvin_per_count;

  const auto direct = direct_estimate(spec, full_plan(spec, {}, {}), observer, {contrast_k},
                                      {.accuracy = Accuracy::normal(), .seed = 3});

  ASSERT_TRUE(direct) << direct.error().message;
  const DirectPoint& point = direct->front();
  const ThresholdByTrials trials = threshold_by_trials(spec, observer, point, contrast_k, scenes, 17);
  const double error = std::hypot(point.standard_error_pitch, trials.standard_error_pitch);
  std::printf(
      "noise %5.2f counts, contrast %6.1f counts, seen %6.2f: direct %.4f +- %.4f, trials %.4f +- %.4f (%+.2f %%)\n",
      rounded.noise_counts, rounded.contrast_counts, point.seen_delta_t_k / spec.kelvin_per_count, point.s75_pitch,
      point.standard_error_pitch, trials.s75_pitch, trials.standard_error_pitch,
      100 * (point.s75_pitch / trials.s75_pitch - 1));
  EXPECT_NEAR(point.s75_pitch, trials.s75_pitch, 0.01 * trials.s75_pitch + 3 * error)
      << rounded.noise_counts << " counts of noise, contrast " << rounded.contrast_counts;
}

}  // namespace todbench::test
