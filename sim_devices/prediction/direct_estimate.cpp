// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/direct_estimate.h"

#include <fmt/format.h>
#include <algorithm>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <numbers>
#include <optional>

#include "acquisition/base/try.h"
#include "sim_devices/prediction/local_crossing.h"
#include "sim_devices/prediction/size_trial.h"
#include "sim_devices/sensor/effect_display.h"
#include "sim_devices/sensor/effect_image_dance.h"
#include "sim_devices/sensor/effect_quantisation.h"
#include "sim_devices/sensor/image_chain.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

constexpr double size_step = 1.08;   ///< sizes are powers of it, so that contrasts share banks and noise
constexpr int smallest_index = -20;  ///< 0.21 pitch
constexpr int largest_index = 48;    ///< 40 pitches
constexpr int scout_draws = 16;

double size_of(int index) {
  return std::pow(size_step, index);
}

/// Conditions for judging a contrast.
struct AskedContrast {
  double delta_t_k = 0;
  WhiteNoise white;                     ///< rounding included
  std::optional<PixelContrast> pixels;  ///< set if rounding is not noise, or if something is clipped
};

/// Sizes on demand for one sensor and observer.
class SizeLadder {
 public:
  SizeLadder(const ImageChain& chain, TemplateObserver& observer, TrialConditions conditions,
             const DirectEstimateOptions& options)
      : chain_(chain),
        observer_(observer),
        conditions_(std::move(conditions)),
        options_(options),
        stream_(options.seed, "direct_estimate") {}

  [[nodiscard]] Result<Proportion> proportion(int index, const AskedContrast& asked, int draws) {
    if (options_.stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
    auto& slot = sizes_[index];
    if (slot == nullptr) {
      const double size = size_of(index);
      TODBENCH_TRY(auto bank, observer_.bank(size * conditions_.samples_per_pitch, conditions_.samples_per_pitch));
      slot = std::make_unique<SizeTrial>(chain_, bank, size, conditions_,
                                         stream_.sub(static_cast<std::uint64_t>(index - smallest_index)));
    }
    if (asked.pixels) return slot->pixel_proportion(*asked.pixels, draws);
    return slot->proportion(asked.white, std::abs(asked.delta_t_k), draws);
  }

 private:
  const ImageChain& chain_;
  TemplateObserver& observer_;
  TrialConditions conditions_;
  DirectEstimateOptions options_;
  RandomStream stream_;
  std::map<int, std::unique_ptr<SizeTrial>> sizes_;
};

/// Largest index with a proportion below 75 % whose successor is not below: the first crossing from above.
Result<int> bracket(SizeLadder& ladder, const AskedContrast& asked) {
  int index = 9;  // 2 pitches
  for (;; index += 4) {
    if (index > largest_index) {
      return fail(ErrorCode::invalid_input,
                  fmt::format("at a contrast of {:g} K, no size up to {:.0f} pitches reaches 75 % correct answers",
                              asked.delta_t_k, size_of(largest_index)));
    }
    TODBENCH_TRY(const auto p, ladder.proportion(index, asked, scout_draws));
    if (p.mean > 0.8) break;
  }
  for (--index; index >= smallest_index; --index) {
    TODBENCH_TRY(const auto p, ladder.proportion(index, asked, scout_draws));
    if (p.mean < 0.75) return index;
  }
  return fail(ErrorCode::invalid_input,
              "even the smallest target is recognised: there is no threshold above 0.2 pitch");
}

/// One pass with a fixed number of draws: six sizes around the threshold, moved until it lies between the middle two.
struct Pass {
  DirectPoint point;
  int below = 0;  ///< index of the largest size below the threshold
};

Result<Pass> one_pass(SizeLadder& ladder, const AskedContrast& asked, int below, int draws) {
  for (int attempt = 0; attempt < 4; ++attempt) {
    below = std::clamp(below, smallest_index + 2, largest_index - 3);
    DirectPoint point;
    point.delta_t_k = asked.delta_t_k;
    point.seen_delta_t_k = asked.pixels ? asked.pixels->seen_k : asked.delta_t_k;
    point.noise_draws = draws;
    std::vector<double> xs;
    std::vector<Proportion> ps;
    for (int k = below - 2; k <= below + 3; ++k) {
      TODBENCH_TRY(const auto p, ladder.proportion(k, asked, draws));
      xs.push_back((k - below) * std::log(size_step));
      ps.push_back(p);
      point.sizes_pitch.push_back(size_of(k));
      point.proportion_correct.push_back(p.mean);
    }
    const auto found = local_crossing(xs, ps);
    if (!found) break;
    const int move = static_cast<int>(std::floor(found->x / std::log(size_step)));
    if (move != 0 && attempt < 3) {
      below += std::clamp(move, -3, 3);
      continue;
    }
    point.s75_pitch = size_of(below) * std::exp(found->x);
    point.standard_error_pitch = point.s75_pitch * found->standard_error;
    return Pass{std::move(point), below};
  }
  return fail(ErrorCode::invalid_input,
              "the proportion correct does not rise with size near 75 %, so the contrast has no threshold");
}

/// Message: why the demanded tolerance cannot be met, which one can, and in which time.
std::string out_of_reach(double contrast, double asked_percent, double needed_draws, double reachable_percent,
                         double seconds) {
  return fmt::format(
      "a tolerance of {:.3g} % cannot be met at a contrast of {:g} K: a standard error of half the tolerance needs "
      "{:.0f} noise draws per size, the maximum is {}. The best reachable tolerance is {:.2g} %, in about {:.1f} s",
      2 * asked_percent, contrast, needed_draws, Accuracy::max_noise_draws, 2 * reachable_percent, seconds);
}

Result<DirectPoint> estimate_contrast(SizeLadder& ladder, const AskedContrast& asked_contrast, const Accuracy& accuracy,
                                      const std::function<double(double)>& seconds_at) {
  TODBENCH_TRY(const auto bracketed, bracket(ladder, asked_contrast));
  int below = bracketed, draws = accuracy.noise_draws;
  for (;;) {
    TODBENCH_TRY(auto pass, one_pass(ladder, asked_contrast, below, draws));
    const double reached = 100 * pass.point.standard_error_pitch / pass.point.s75_pitch;
    const double asked = accuracy.standard_error_percent;
    if (!(asked > 0) || reached <= asked) return std::move(pass.point);
    // The error falls with the square root of the draws. A tenth is added, because it is itself an estimate.
    const double needed = 1.1 * draws * std::pow(reached / asked, 2);
    if (needed > 2 * Accuracy::max_noise_draws || draws == Accuracy::max_noise_draws) {
      const double reachable = 1.05 * reached * std::sqrt(draws / double{Accuracy::max_noise_draws});
      return fail(ErrorCode::invalid_input,
                  out_of_reach(asked_contrast.delta_t_k, asked, needed, reachable, seconds_at(pass.point.s75_pitch)));
    }
    below = pass.below;
    draws = std::min(static_cast<int>(needed) + 1, Accuracy::max_noise_draws);
  }
}

/// Temporal standard deviation of a pixel of the surround in frames: rounded, and averaged over the places of pixels
/// within a count, which the fixed pattern spreads.
double noise_of_frames_k(const SensorSpec& sensor, const Quantiser& quantiser, double noise_k) {
  constexpr int places = 41;
  double variance = 0;
  for (int i = 0; i < places; ++i) {
    const double z = std::numbers::sqrt2 * boost::math::erf_inv(2 * (i + 0.5) / places - 1);
    variance += std::pow(quantiser.reading(sensor.fixed_pattern_k * z, noise_k).sd_k, 2) / places;
  }
  return std::sqrt(variance);
}

/// Contrast of a camera with counts that are too coarse or too few for it.
Result<PixelContrast> pixel_contrast(const SensorSpec& sensor, const SensorPlan& plan,
                                     const TemplateObserverSpec& observer, double delta_t_k,
                                     const DirectEstimateOptions& options) {
  PixelContrast out;
  const double rounding_k2 = plan.simulates(Effect::quantisation) ? std::pow(sensor.kelvin_per_count, 2) / 12 : 0;
  out.noise_k = std::sqrt(std::max(0.0, white_variance_k2(sensor, plan, 1) - rounding_k2));
  out.background_k = options.background_k.value_or(sensor.scene_temperature_k);
  const Quantiser quantiser(sensor, out.background_k);
  const double displayed_k = out.noise_k * display_noise_gain(sensor);
  if (const auto scene = options.scene_delta_t_k.find(delta_t_k); scene != options.scene_delta_t_k.end()) {
    out.scene_k = scene->second;
    out.seen_k = delta_t_k;
  } else {
    out.scene_k = delta_t_k;
    const double sd_k = std::hypot(displayed_k, sensor.fixed_pattern_k);
    out.seen_k = quantiser.reading(delta_t_k, sd_k).mean_k - quantiser.reading(0, sd_k).mean_k;
  }
  const double highest_k = sensor.offset_k + sensor.kelvin_per_count * (std::exp2(sensor.bits) - 1);
  if (plan.simulates(Effect::quantisation) && (out.background_k < sensor.offset_k || out.background_k > highest_k)) {
    return fail(ErrorCode::invalid_input,
                fmt::format("a scene of {:g} K is outside the range of the counts, {:g} to {:g} K", out.background_k,
                            sensor.offset_k, highest_k));
  }
  if (!(out.seen_k / delta_t_k > 1e-6)) {
    return fail(ErrorCode::invalid_input,
                fmt::format("a contrast of {:g} K disappears in the rounding to counts of {:g} K", delta_t_k,
                            sensor.kelvin_per_count));
  }
  // An observer of limited efficiency adds white noise in proportion to that of the frames.
  const double factor = observer.sensor_noise_factor;
  out.internal_k =
      std::hypot(observer.internal_noise * out.seen_k,
                 std::sqrt(std::max(0.0, factor * factor - 1)) * noise_of_frames_k(sensor, quantiser, displayed_k));
  return out;
}

bool needs_pixels(const SensorSpec& sensor, const SensorPlan& plan, double delta_t_k,
                  const DirectEstimateOptions& options) {
  const auto scene = options.scene_delta_t_k.find(delta_t_k);
  const double scene_k = scene == options.scene_delta_t_k.end() ? delta_t_k : scene->second;
  return (plan.simulates(Effect::quantisation) && rounds_coarsely(sensor)) ||
         reaches_an_end(sensor, scene_k, options.background_k.value_or(sensor.scene_temperature_k));
}

TrialConditions trial_conditions(const SensorSpec& spec, const SensorPlan& plan, const TemplateObserver& observer,
                                 const DirectEstimateOptions& options) {
  TrialConditions conditions{.sensor = as_planned(spec, plan),
                             .motion = options.motion,
                             .samples_per_pitch = options.samples_per_pitch,
                             .phases_per_axis = options.accuracy.phases_per_axis,
                             .search_step_samples = observer.spec().search_step_samples,
                             .orientations = options.orientations};
  if (options.samples_per_pitch == 0) conditions.samples_per_pitch = conditions.sensor.samples_per_pitch();
  if (conditions.sensor.super_resolution_frames == 0) conditions.sensor.microscan = conditions.samples_per_pitch;
  return conditions;
}

/// Conditions for a contrast. `sensor` is that of the trial conditions.
Result<AskedContrast> asked_contrast(const SensorSpec& sensor, const SensorPlan& plan,
                                     const TemplateObserverSpec& observer, double delta_t_k,
                                     const DirectEstimateOptions& options) {
  const double magnitude = std::abs(delta_t_k);
  if (!(magnitude > 0)) return fail(ErrorCode::invalid_input, "a contrast of 0 K has no threshold");
  const double white_k = std::sqrt(white_variance_k2(sensor, plan, observer.sensor_noise_factor));
  AskedContrast asked{.delta_t_k = delta_t_k,
                      .white = {.sensor = white_k / magnitude, .internal = observer.internal_noise},
                      .pixels = std::nullopt};
  if (needs_pixels(sensor, plan, delta_t_k, options)) {
    TODBENCH_TRY(asked.pixels, pixel_contrast(sensor, plan, observer, delta_t_k, options));
  }
  return asked;
}

/// Curve over the sizes between nearly chance and nearly certain.
Result<ProportionCurve> curve_of(SizeLadder& ladder, const AskedContrast& asked, int draws) {
  constexpr double next_to_chance = 0.26, next_to_certainty = 0.9985;
  TODBENCH_TRY(const auto middle, bracket(ladder, asked));
  std::map<int, Proportion> found;
  for (int index = middle; index >= smallest_index; --index) {
    TODBENCH_TRY(const auto p, ladder.proportion(index, asked, draws));
    found[index] = p;
    if (p.mean < next_to_chance) break;
  }
  for (int index = middle + 1; index <= largest_index; ++index) {
    TODBENCH_TRY(const auto p, ladder.proportion(index, asked, draws));
    found[index] = p;
    if (p.mean > next_to_certainty) break;
  }
  ProportionCurve curve;
  curve.delta_t_k = asked.delta_t_k;
  for (const auto& [index, p] : found) {
    curve.sizes_pitch.push_back(size_of(index));
    curve.proportion_correct.push_back(p.mean);
    curve.standard_error.push_back(std::sqrt(p.variance));
  }
  return curve;
}

/// Calls `find` (ladder, contrast, sensor of the conditions) for every contrast. The contrasts share the ladders and
/// with them their images.
template <typename Found, typename Find>
Result<std::vector<Found>> for_every_contrast(const SensorSpec& spec, const SensorPlan& plan,
                                              TemplateObserver& observer, const std::vector<double>& delta_t_k,
                                              const DirectEstimateOptions& options, Find find) {
  TODBENCH_TRY_VOID(check_sample_shape(spec, observer.spec()));
  const ImageChain chain(spec, plan, options.accuracy, options.motion);
  TrialConditions conditions = trial_conditions(spec, plan, observer, options);
  const SensorSpec sensor = conditions.sensor;
  SizeLadder ladder(chain, observer, conditions, options);
  conditions.by_pixels = true;
  SizeLadder pixel_ladder(chain, observer, std::move(conditions), options);
  std::vector<Found> all;
  for (const double contrast : delta_t_k) {
    TODBENCH_TRY(const auto asked, asked_contrast(sensor, plan, observer.spec(), contrast, options));
    Result<Found> found = find(asked.pixels ? pixel_ladder : ladder, asked, sensor);
    if (!found) return tl::unexpected(found.error());
    all.push_back(*std::move(found));
  }
  return all;
}

}  // namespace

Result<std::vector<DirectPoint>> direct_estimate(const SensorSpec& spec, const SensorPlan& plan,
                                                 TemplateObserver& observer, const std::vector<double>& delta_t_k,
                                                 const DirectEstimateOptions& options) {
  const auto point_of = [&](SizeLadder& ladder, const AskedContrast& asked, const SensorSpec& sensor) {
    return estimate_contrast(ladder, asked, options.accuracy, [&](double s75) {
      return predicted_direct_seconds(observer.spec(), sensor, s75, Accuracy::max_noise_draws,
                                      options.accuracy.phases_per_axis);
    });
  };
  return for_every_contrast<DirectPoint>(spec, plan, observer, delta_t_k, options, point_of);
}

Result<std::vector<ProportionCurve>> proportion_curves(const SensorSpec& spec, const SensorPlan& plan,
                                                       TemplateObserver& observer, const std::vector<double>& delta_t_k,
                                                       const DirectEstimateOptions& options) {
  const auto curve = [&](SizeLadder& ladder, const AskedContrast& asked, const SensorSpec&) {
    return curve_of(ladder, asked, options.accuracy.noise_draws);
  };
  return for_every_contrast<ProportionCurve>(spec, plan, observer, delta_t_k, options, curve);
}

double predicted_direct_seconds(const TemplateObserverSpec& observer, const SensorSpec& sensor, double s75_pitch,
                                int noise_draws, int phases_per_axis) {
  const double steps = 2 * observer.search_range_samples / observer.search_step_samples + 1;
  const double templates = 4 * steps * steps;
  const double n = sensor.samples_per_pitch();
  const double half = std::ceil(observer.window_size_factor * s75_pitch + observer.window_margin_pitch);
  const double samples = std::pow(2 * half * n, 2);
  const double phases = std::pow(phases_per_axis / n, 2) * dances_per_phase(sensor, phases_per_axis);
  // Building a bank costs as much as sixty of its projections. A draw is projected once and compared at every phase;
  // with rounded pixels it is projected at as many phases as an axis has.
  const double projections = rounds_coarsely(sensor) ? 2 * phases_per_axis / n : 1;
  const double per_size = (noise_draws * projections + 60.0) * templates * samples + noise_draws * templates * phases;
  return 5 * per_size * 5e-11;
}

}  // namespace todbench
