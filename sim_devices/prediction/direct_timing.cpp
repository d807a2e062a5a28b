// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/direct_timing.h"

#include <ctime>

#include <algorithm>
#include <cmath>

#include "acquisition/base/try.h"
#include "sim_devices/prediction/size_trial.h"
#include "sim_devices/sensor/effect_quantisation.h"
#include "sim_devices/sensor/image_chain.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

constexpr int timed_draws = 24;
constexpr int scout_draws = 16;  // of direct_estimate()
constexpr int final_sizes = 5;

/// Sizes that the search visits beyond the final ones: from 2 pitches upwards in steps of four, then down one by one.
double scouted_sizes(double s75_pitch) {
  const double index = std::log(s75_pitch) / std::log(1.08);
  const double upwards = index < 8 ? 1 : 1 + std::ceil((index - 8) / 4);
  const double downwards = index < 8 ? 9 - index : 2;
  return std::max(0.0, upwards + downwards - 3);  // three of them are among the final ones
}

}  // namespace

double thread_seconds() {
  timespec now{};
  (void)::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Result<double> measured_direct_seconds(const SensorSpec& spec, const SensorPlan& plan,
                                       const TemplateObserverSpec& observer_spec, double delta_t_k, double s75_pitch,
                                       double noise_draws, const Accuracy& accuracy, SceneMotion motion) {
  const SensorSpec sensor = as_planned(spec, plan);
  const int samples_per_pitch = sensor.samples_per_pitch();
  const bool by_pixels = plan.simulates(Effect::quantisation) && rounds_coarsely(sensor);
  const TrialConditions conditions{.sensor = sensor,
                                   .motion = motion,
                                   .samples_per_pitch = samples_per_pitch,
                                   .phases_per_axis = accuracy.phases_per_axis,
                                   .search_step_samples = observer_spec.search_step_samples,
                                   .by_pixels = by_pixels};
  TemplateObserver observer(observer_spec, triangle_alternatives());
  const ImageChain chain(spec, plan, accuracy, motion);
  const double white_k = std::sqrt(white_variance_k2(sensor, plan, observer_spec.sensor_noise_factor));
  const WhiteNoise white{.sensor = white_k / std::abs(delta_t_k), .internal = observer_spec.internal_noise};
  // Tabulates the transfer function, which would otherwise be timed with the first size.
  (void)chain.image(triangle(s75_pitch, Apex::up));
  const double t0 = thread_seconds();
  TODBENCH_TRY(auto bank, observer.bank(s75_pitch * samples_per_pitch, samples_per_pitch));
  SizeTrial trial(chain, bank, s75_pitch, conditions, RandomStream(1, "direct_timing"));
  const auto judge = [&] {
    if (!by_pixels) return trial.proportion(white, std::abs(delta_t_k), timed_draws);
    return trial.pixel_proportion({.scene_k = delta_t_k,
                                   .seen_k = delta_t_k,
                                   .noise_k = white_k,
                                   .internal_k = observer_spec.internal_noise * std::abs(delta_t_k),
                                   .background_k = sensor.scene_temperature_k},
                                  timed_draws);
  };
  const double t1 = thread_seconds();
  (void)judge();
  const double t2 = thread_seconds();
  (void)judge();
  const double t3 = thread_seconds();
  const double build = t1 - t0;
  const double compare = (t3 - t2) / timed_draws;
  const double project = std::max(0.0, (t2 - t1) / timed_draws - compare);
  // With a demanded standard error there is a first pass with fewer draws, whose comparisons are repeated.
  const double first_pass = accuracy.standard_error_percent > 0 && noise_draws > accuracy.noise_draws
                                ? static_cast<double>(accuracy.noise_draws)
                                : 0.0;
  const double scouts = scouted_sizes(s75_pitch);
  return (final_sizes + scouts) * build + scouts * scout_draws * (project + compare) +
         final_sizes * (noise_draws * project + (noise_draws + first_pass + scout_draws) * compare);
}

}  // namespace todbench
