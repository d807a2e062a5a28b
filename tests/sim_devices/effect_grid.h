// Scenes on which the planner of effects is held against brute force.
#pragma once

#include <cmath>
#include <ctime>
#include <map>
#include <string>
#include <vector>

#include "sim_devices/prediction/direct_estimate.h"
#include "sim_devices/prediction/effect_planner.h"
#include "tests/sim_devices/reference.h"
#include "tod/test_pattern.h"

namespace todbench::test {

struct GridScene {
  std::string name;
  SensorSpec sensor;
  double delta_t_k = 1.93;
  SceneMotion motion{};
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

/// Acuity with a plan over that with everything simulated, minus 1, in percent: the same noise for both. Mean and
/// standard error over seeds; processor time of both.
struct TrueChange {
  double percent = 0, standard_error = 0;
  double brute_s = 0, planned_s = 0;
};

class BruteForce {
 public:
  BruteForce(const GridScene& scene, int seeds, int draws) : scene_(scene), seeds_(seeds) {
    accuracy_.phases_per_axis = 4;
    accuracy_.noise_draws = draws;
    const SensorPlan everything = full_plan(scene.sensor, {}, {}, scene.motion);
    everything_ = estimates(everything, ShownOrientations::all);
    brute_s_ = time_of(everything);  // after the banks have been built
  }

  [[nodiscard]] TrueChange change(const SensorPlan& plan) {
    std::string decisions;
    for (const auto& d : plan.decisions) decisions += d.decision == Decision::skip ? '-' : '+';
    if (const auto found = known_.find(decisions); found != known_.end()) return found->second;
    TrueChange out{.percent = 0, .standard_error = 0, .brute_s = brute_s_, .planned_s = time_of(plan)};
    const auto planned = estimates(plan, ShownOrientations::all);
    double sum = 0, squares = 0;
    for (std::size_t s = 0; s < planned.size(); ++s) {
      const double change = 100 * (everything_[s] / planned[s] - 1);
      sum += change;
      squares += change * change;
    }
    const auto n = static_cast<double>(seeds_);
    out.percent = sum / n;
    out.standard_error = seeds_ > 1 ? std::sqrt(std::max(0.0, squares - sum * sum / n) / (n - 1) / n) : 0;
    known_[decisions] = out;
    return out;
  }

  [[nodiscard]] TemplateObserver& observer() { return observer_; }

 private:
  double time_of(const SensorPlan& plan) {
    const std::clock_t begin = std::clock();
    DirectEstimateOptions options;
    options.motion = scene_.motion;
    options.accuracy = accuracy_;
    (void)direct_estimate(scene_.sensor, plan, observer_, {scene_.delta_t_k}, options);
    return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  }

  std::vector<double> estimates(const SensorPlan& plan, ShownOrientations orientations) {
    std::vector<double> sizes;
    for (int seed = 1; seed <= seeds_; ++seed) {
      DirectEstimateOptions options;
      options.motion = scene_.motion;
      options.accuracy = accuracy_;
      options.seed = static_cast<std::uint64_t>(seed);
      options.orientations = orientations;
      const auto point = direct_estimate(scene_.sensor, plan, observer_, {scene_.delta_t_k}, options);
      sizes.push_back(point ? (*point)[0].s75_pitch : std::nan(""));
    }
    return sizes;
  }

  GridScene scene_;
  int seeds_;
  Accuracy accuracy_;
  TemplateObserver observer_{{}, triangle_alternatives()};
  double brute_s_ = 0;
  std::vector<double> everything_;
  std::map<std::string, TrueChange> known_;  ///< by decisions
};

inline Result<EffectPlan> planned(const GridScene& scene, TemplateObserver& observer, double tolerance_percent) {
  EffectPlannerOptions options;
  options.tolerance_percent = tolerance_percent;
  return plan_effects(scene.sensor, observer, {.delta_t_k = {scene.delta_t_k}, .motion = scene.motion}, options);
}

}  // namespace todbench::test
