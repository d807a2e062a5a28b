// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes on which the planner of effects is held against brute force.
#pragma once

#include <cmath>
#include <ctime>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "sim_devices/prediction/direct_estimate.h"
#include "sim_devices/prediction/effect_planner.h"
#include "sim_devices/sensor/effect_image_dance.h"
#include "sim_devices/sensor/effect_turbulence.h"
#include "tests/sim_devices/reference.h"
#include "tod/plate/test_pattern.h"

namespace todbench::test {

struct GridScene {
  std::string name;
  SensorSpec sensor;
  double delta_t_k = 1.93;
  SceneMotion motion{};
  TemplateObserverSpec observer{};
};

/// A sensor that shows every effect, each so many times as strong as is usual for an uncooled camera.
inline SensorSpec sensor_with_everything(double strength, int microscan) {
  SensorSpec spec = sc2000();
  spec.name = "everything";
  spec.aberration_sigma_pitch = 0.05 * strength;
  spec.time_constant_ms = 8;
  spec.fixed_pattern_k = 0.01 * strength;
  spec.row_noise_k = 0.006 * strength;
  spec.column_noise_k = 0.004 * strength;
  spec.dead_pixel_share = 0.001 * strength;
  spec.frames_averaged = 2;
  spec.display_blur_samples = 0.05 * strength;
  spec.microscan = microscan;
  return spec;
}

/// Velocity at which the target moves so many pitches within a time constant, obliquely.
inline SceneMotion motion_of(const SensorSpec& spec, double smear_pitch) {
  const double v = smear_pitch * spec.ifov_mrad() / (spec.time_constant_ms * 1e-3);
  return {.x_mrad_s = 0.8 * v, .y_mrad_s = 0.6 * v};
}

/// Strength x contrast (and with it size: 0.7 to 6 pitches) x motion x sampling: 72 scenes.
inline std::vector<GridScene> all_scenes() {
  std::vector<GridScene> scenes;
  for (const double strength : {0.3, 1.0, 3.0}) {
    for (const double delta_t_k : {16.9, 1.93, 0.23, 0.1}) {
      for (const double smear : {0.0, 0.05, 0.3}) {
        for (const int microscan : {1, 2}) {
          const SensorSpec spec = sensor_with_everything(strength, microscan);
          char name[80];
          std::snprintf(name, sizeof name, "strength %.1f, %.2f K, smear %.2f, %dx%d", strength, delta_t_k, smear,
                        microscan, microscan);
          scenes.push_back({name, spec, delta_t_k, motion_of(spec, smear)});
        }
      }
    }
  }
  return scenes;
}

/// The tuned observer of hvs/observers/human-like-1.toml: narrower, sees the sensor's noise enlarged.
inline TemplateObserverSpec human_like() {
  TemplateObserverSpec spec;
  spec.name = "human-like-1";
  spec.blur_sigma_samples = 0.5;
  spec.internal_noise = 0.025;
  spec.sensor_noise_factor = 1.75;
  return spec;
}

/// A scene of which nothing was used to set the bounds: pitch, optics, band, detector, strength of every effect alone,
/// sampling, motion, contrast and observer are drawn. Each `set` has scenes of its own.
inline GridScene random_scene(std::uint64_t set, std::uint64_t number) {
  const RandomStream random = RandomStream(set, "effect_planner.validation").sub(number);
  std::uint64_t next = 0;
  const auto uniform = [&](double low, double high) { return low + (high - low) * random.uniform(next++); };
  const auto decades = [&](double low, double high) { return low * std::pow(high / low, random.uniform(next++)); };
  /// Absent in a quarter of the scenes.
  const auto strength = [&](double low, double high) {
    const bool absent = uniform(0, 1) < 0.25;
    const double value = decades(low, high);
    return absent ? 0.0 : value;
  };
  GridScene scene;
  SensorSpec& s = scene.sensor;
  s.name = "random";
  s.pitch_um = decades(12, 50);
  s.detector_um = s.pitch_um * uniform(0.7, 1);
  s.focal_length_mm = decades(10, 100);
  s.f_number = uniform(1, 1.8);
  if (uniform(0, 1) < 0.3) {
    s.wavelength_min_um = 3.4;
    s.wavelength_max_um = 5;
  }
  s.aberration_sigma_pitch = strength(0.02, 0.4);
  s.netd_k = decades(0.02, 0.15);
  s.fixed_pattern_k = s.netd_k * strength(0.03, 1);
  s.time_constant_ms = uniform(4, 15);
  s.row_noise_k = s.netd_k * strength(0.02, 0.5);
  s.column_noise_k = s.netd_k * strength(0.02, 0.5);
  s.dead_pixel_share = strength(1e-4, 5e-3);
  s.frames_averaged = 1 << static_cast<int>(uniform(0, 3));
  s.display_blur_samples = strength(0.05, 0.5);
  if (uniform(0, 1) < 0.25) s.display = DisplayReconstruction::bilinear;
  s.kelvin_per_count = decades(0.003, 0.15);
  // Fine counts end soon: the scene lies in their middle, or nothing of it is seen.
  s.offset_k = std::max(s.offset_k, s.scene_temperature_k - s.kelvin_per_count * std::exp2(s.bits - 1));
  const double sampling = uniform(0, 1);
  if (sampling > 0.4 && sampling < 0.8) s.microscan = 2;
  if (sampling >= 0.8) s.super_resolution_frames = 16;
  const double smear = strength(0.01, 0.7), direction = uniform(0, 2 * std::numbers::pi);
  const double v = smear * s.ifov_mrad() / (s.time_constant_ms * 1e-3);
  scene.motion = {.x_mrad_s = v * std::cos(direction), .y_mrad_s = v * std::sin(direction)};
  if (uniform(0, 1) < 0.3) scene.observer = human_like();
  // From 1.5 times the noise that the observer sees in a sample: sizes up to 7 pitches.
  const double noise = s.netd_k * scene.observer.sensor_noise_factor / std::sqrt(s.exposures_per_sample());
  scene.delta_t_k = std::max(noise, s.fixed_pattern_k) * decades(1.5, 250);
  char name[160];
  std::snprintf(name, sizeof name, "set %d scene %2d (%s, %dx%d, S/N %.3g, smear %.2g)", static_cast<int>(set),
                static_cast<int>(number), scene.observer.name.c_str(), s.samples_per_pitch(), s.samples_per_pitch(),
                scene.delta_t_k / noise, smear);
  scene.name = name;
  return scene;
}

/// A scene of random_scene() at the far end of a path of air: the contrast is what the air leaves of it, turbulence is
/// drawn so that it is nothing, little or much before this camera, and the path's own radiance moves the level.
inline GridScene random_air_scene(std::uint64_t set, std::uint64_t number) {
  GridScene scene = random_scene(set, number);
  const RandomStream random = RandomStream(set, "effect_planner.air").sub(number);
  SensorSpec& s = scene.sensor;
  // Narrow fields, in which turbulence decides, as often as wide ones; the same smear in pitches.
  const double wide_mrad = s.ifov_mrad();
  s.focal_length_mm *= std::pow(30.0, random.uniform(0));
  scene.motion.x_mrad_s *= s.ifov_mrad() / wide_mrad;
  scene.motion.y_mrad_s *= s.ifov_mrad() / wide_mrad;
  s.turbulence_path_m = 200 * std::pow(40.0, random.uniform(1));
  s.turbulence_cn2_m_minus_2_3 = 1e-15 * std::pow(1e3, random.uniform(2));
  // Beyond a blur of a pitch and a half there is nothing to plan: every effect is small beside it.
  while (turbulence_strength(s) > 20) s.turbulence_cn2_m_minus_2_3 /= 2;
  // The air takes up to nine tenths, and what is left is seen in noise.
  const double noise = s.netd_k * scene.observer.sensor_noise_factor / std::sqrt(s.exposures_per_sample());
  const double transmittance = std::exp(-2.3 * random.uniform(3));
  scene.delta_t_k = std::max(transmittance * scene.delta_t_k, 1.5 * std::max(noise, s.fixed_pattern_k));
  s.offset_k -= 20 * (1 - transmittance) * random.uniform(4);
  char name[120];
  std::snprintf(name, sizeof name, ", tau %.2f, Cn2 %.1e over %.0f m, strength %.2g", transmittance,
                s.turbulence_cn2_m_minus_2_3, s.turbulence_path_m, turbulence_strength(s));
  scene.name += name;
  return scene;
}

/// A scene of random_air_scene() whose frames dance, by half a pitch per axis at most, from much faster than a frame to
/// slower than a presentation.
inline GridScene random_dance_scene(std::uint64_t set, std::uint64_t number) {
  GridScene scene = random_air_scene(set, number);
  const RandomStream random = RandomStream(set, "effect_planner.dance").sub(number);
  SensorSpec& s = scene.sensor;
  s.turbulence_correlation_ms = std::pow(1000.0, random.uniform(0));
  if (random.uniform(1) < 0.5) s.exposure_ms = 1000 / s.frame_rate_hz * random.uniform(2);
  while (dance_sd_pitch(s) > 0.5) s.turbulence_cn2_m_minus_2_3 /= 2;
  char name[80];
  std::snprintf(name, sizeof name, ", dance of %.2g pitches, %.3g ms", dance_sd_pitch(s), s.turbulence_correlation_ms);
  scene.name += name;
  return scene;
}

/// Observers that keep their template banks for all scenes.
class Observers {
 public:
  [[nodiscard]] TemplateObserver& of(const TemplateObserverSpec& spec) {
    auto& slot = observers_[spec.name];
    if (slot == nullptr) slot = std::make_unique<TemplateObserver>(spec, triangle_alternatives());
    return *slot;
  }

 private:
  std::map<std::string, std::unique_ptr<TemplateObserver>> observers_;
};

/// Acuity with a plan over that with everything simulated, minus 1, in percent: the same noise for both, draw by draw.
/// Mean and standard error over seeds; processor time of one estimate each.
struct TrueChange {
  double percent = 0, standard_error = 0;
  double brute_s = 0, planned_s = 0;
};

/// Everything simulated on the lattice of Accuracy::reference(), against a plan on the lattice that belongs to its
/// tolerance: the change is that of skipped effects and of numerical errors together.
class BruteForce {
 public:
  BruteForce(GridScene scene, TemplateObserver& observer, int seeds, int draws)
      : scene_(std::move(scene)), observer_(observer), seeds_(seeds), draws_(draws) {
    const SensorPlan everything = full_plan(scene_.sensor, {}, {}, scene_.motion);
    everything_ = estimates(everything, Accuracy::reference());  // builds the banks, too
    brute_s_ = time_of(everything, Accuracy::reference());
  }

  [[nodiscard]] TrueChange change(const SensorPlan& plan, double tolerance_percent) {
    const Accuracy accuracy = Accuracy::for_tolerance(tolerance_percent);
    const auto planned = estimates(plan, accuracy);
    double sum = 0, squares = 0;
    for (std::size_t s = 0; s < planned.size(); ++s) {
      const double change = 100 * (everything_[s] / planned[s] - 1);
      sum += change;
      squares += change * change;
    }
    const auto n = static_cast<double>(seeds_);
    return {.percent = sum / n,
            .standard_error = seeds_ > 1 ? std::sqrt(std::max(0.0, squares - sum * sum / n) / (n - 1) / n) : 0,
            .brute_s = brute_s_,
            .planned_s = time_of(plan, accuracy)};
  }

 private:
  [[nodiscard]] DirectEstimateOptions options(Accuracy accuracy) const {
    DirectEstimateOptions options;
    options.motion = scene_.motion;
    options.accuracy = accuracy;
    options.accuracy.noise_draws = draws_;
    options.accuracy.standard_error_percent = 0;
    return options;
  }

  [[nodiscard]] double time_of(const SensorPlan& plan, const Accuracy& accuracy) {
    const std::clock_t begin = std::clock();
    (void)direct_estimate(scene_.sensor, plan, observer_, {scene_.delta_t_k}, options(accuracy));
    return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  }

  [[nodiscard]] std::vector<double> estimates(const SensorPlan& plan, const Accuracy& accuracy) {
    std::vector<double> sizes;
    for (int seed = 1; seed <= seeds_; ++seed) {
      DirectEstimateOptions chosen = options(accuracy);
      chosen.seed = static_cast<std::uint64_t>(seed);
      chosen.orientations = ShownOrientations::all;
      const auto point = direct_estimate(scene_.sensor, plan, observer_, {scene_.delta_t_k}, chosen);
      sizes.push_back(point ? (*point)[0].s75_pitch : std::nan(""));
    }
    return sizes;
  }

  GridScene scene_;
  TemplateObserver& observer_;
  int seeds_, draws_;
  double brute_s_ = 0;
  std::vector<double> everything_;
};

inline Result<EffectPlan> planned(const GridScene& scene, TemplateObserver& observer, double tolerance_percent) {
  EffectPlannerOptions options;
  options.tolerance_percent = tolerance_percent;
  return plan_effects(scene.sensor, observer, {.delta_t_k = {scene.delta_t_k}, .motion = scene.motion}, options);
}

}  // namespace todbench::test
