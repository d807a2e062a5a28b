// SPDX-License-Identifier: GPL-3.0-or-later
// S75 of the studied imagers by several observers: templates, eye, ideal observer, and a program (a matched filter).
#pragma once

#include <array>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "hvs/observer/known_position.h"
#include "sim_devices/module/module_observer.h"
#include "sim_devices/prediction/local_crossing.h"
#include "sim_devices/prediction/seen_window.h"
#include "sim_devices/prediction/window_noise.h"
#include "sim_devices/sensor/effect_row.h"
#include "tests/sim_devices/prediction/method_transfer.h"
#include "tests/support/source_file.h"

namespace todbench::testing {

/// Pictures of triangles in sampling phases, in kelvin for 1 K of contrast.
class ShownTriangles {
 public:
  static constexpr int phases_per_axis = 4;
  static constexpr std::uint64_t phases = phases_per_axis * phases_per_axis;

  explicit ShownTriangles(const SensorSpec& sensor, const Accuracy& accuracy = Accuracy::normal())
      : sensor_(sensor),
        plan_(full_plan(sensor, {}, {})),
        imager_(sensor, plan_, accuracy),
        window_(sensor, imager_),
        accuracy_(accuracy) {}

  [[nodiscard]] cv::Mat1f picture(double size_pitch, Apex apex, int window_samples, std::uint64_t phase) const {
    const PaintedPolygon painted{triangle(size_pitch * sensor_.samples_per_pitch(), apex), 1};
    return window_.picture(visible_edges(std::span(&painted, 1)), window_samples, offset(phase), 1, phase);
  }
  /// Centroid minus middle of the window, in samples.
  [[nodiscard]] static cv::Point2d offset(std::uint64_t phase) {
    const auto at = [](std::uint64_t step) { return (static_cast<double>(step) + 0.5) / phases_per_axis - 0.5; };
    return {at(phase % phases_per_axis), at(phase / phases_per_axis)};
  }
  [[nodiscard]] WindowNoise noise(int window_samples, std::uint64_t seed) const {
    return {sensor_, plan_, accuracy_, window_samples, seed};
  }
  /// Of the noise per sample, white.
  [[nodiscard]] double noise_k() const { return std::sqrt(white_variance_k2(sensor_, plan_, 1)); }
  [[nodiscard]] const SensorSpec& sensor() const { return sensor_; }

 private:
  SensorSpec sensor_;
  SensorPlan plan_;
  SceneImager imager_;
  SeenWindow window_;
  Accuracy accuracy_;
};

/// Size in pitches that is judged 75 % correct: `proportion` at steps of 8 %, six of them around the crossing.
template <typename ProportionAt>
double size_at_75(ProportionAt proportion) {
  std::map<int, Proportion> known;
  const auto at = [&](int index) {
    const auto [slot, is_new] = known.try_emplace(index);
    if (is_new) slot->second = proportion(std::pow(1.08, index));
    return slot->second;
  };
  int below = 9;
  while (below < 45 && at(below).mean < 0.8) below += 4;
  while (below > -28 && at(below).mean >= 0.75) --below;
  for (int attempt = 0;; ++attempt) {
    std::vector<double> xs;
    std::vector<Proportion> ps;
    for (int k = below - 2; k <= below + 3; ++k) {
      xs.push_back((k - below) * std::log(1.08));
      ps.push_back(at(k));
    }
    const auto found = local_crossing(xs, ps);
    EXPECT_TRUE(found) << below;
    if (!found) return 0;
    const int move = static_cast<int>(std::floor(found->x / std::log(1.08)));
    if (move == 0 || attempt == 3) return std::pow(1.08, below) * std::exp(found->x);
    below += std::clamp(move, -3, 3);
  }
}

/// The observer that knows phase, blur and noise of the camera and adds no noise of its own: largest likelihood of the
/// four pictures in white noise, exact.
inline double ideal_s75_pitch(const ShownTriangles& shown, double delta_t_k) {
  return size_at_75([&](double size) -> Proportion {
    const int window = 2 * static_cast<int>(std::ceil(1.05 * size + 3));
    double sum = 0;
    for (std::uint64_t phase = 0; phase < ShownTriangles::phases; ++phase) {
      std::array<cv::Mat1f, 4> pictures;
      for (std::size_t o = 0; o < 4; ++o) pictures[o] = shown.picture(size, all_apexes[o], window, phase);
      for (std::size_t truth = 0; truth < 4; ++truth) {
        std::swap(pictures[0], pictures[truth]);
        KnownPositionTask task;
        task.noise = shown.noise_k() / delta_t_k;
        for (std::size_t i = 0; i < 4; ++i) {
          task.mean[i] = pictures[i].dot(pictures[0]) - 0.5 * pictures[i].dot(pictures[i]);
          for (std::size_t k = 0; k < 4; ++k) task.gram[i][k] = pictures[i].dot(pictures[k]);
        }
        sum += probability_correct(task, 16);
        std::swap(pictures[0], pictures[truth]);
      }
    }
    return {sum / (4.0 * ShownTriangles::phases), 1e-9};
  });
}

/// A program that reads the noisy pictures: `draws` of each orientation in each phase, for every size. The observer has
/// no noise of its own.
inline double program_s75_pitch(const ShownTriangles& shown, double delta_t_k, const ModulePlan& program, int draws,
                                std::uint64_t seed) {
  TemplateObserverSpec spec;
  spec.internal_noise = 0;
  const auto observer = module_observer(spec, triangle_alternatives(), program, [](std::string_view) {});
  const double s75 = size_at_75([&](double size) -> Proportion {
    const auto prepared =
        observer->prepare(size * shown.sensor().samples_per_pitch(), shown.sensor().samples_per_pitch());
    EXPECT_TRUE(prepared) << prepared.error().message;
    const int window = (*prepared)->window_samples();
    const WindowNoise noise = shown.noise(window, seed);
    const RandomStream ties(seed, "observer_ranking");
    double correct = 0, count = 0;
    for (std::uint64_t draw = 0; draw < static_cast<std::uint64_t>(draws) * 4 * ShownTriangles::phases; ++draw) {
      const auto truth = static_cast<std::size_t>(draw % 4);
      const std::uint64_t phase = draw / 4 % ShownTriangles::phases;
      Patch patch;
      cv::Mat1f kelvin = delta_t_k * shown.picture(size, all_apexes[truth], window, phase) + noise.sensor_k(draw);
      kelvin.convertTo(patch.kelvin, CV_64F);
      patch.phase = ShownTriangles::offset(phase);
      patch.noise_k = shown.noise_k();
      const Choice choice = (*prepared)->choose(patch, delta_t_k, ties.sub(draw));
      correct += choice.alternative == static_cast<int>(truth) ? 1 : 0;
      ++count;
    }
    const double mean = correct / count;
    return {mean, std::max(mean * (1 - mean), 0.25 / count) / count};
  });
  EXPECT_FALSE(observer->failure()) << observer->failure()->message;
  return s75;
}

/// S75 in mrad by the name of the observer, for each imager in order.
using Rankings = std::map<std::string, std::vector<double>>;

}  // namespace todbench::testing
