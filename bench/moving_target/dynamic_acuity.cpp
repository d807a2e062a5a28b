// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/moving_target/dynamic_acuity.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "acquisition/base/try.h"
#include "hvs/observer/open_parameters.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "sim_devices/sensor/effect_exposure.h"
#include "sim_devices/sensor/effect_motion.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

/// Converts the answers to trials of presentations, for the paired ratio.
std::vector<Trial> trials_of(const std::vector<Level>& levels, double delta_t_k) {
  std::vector<Trial> trials;
  for (const Level& level : levels) {
    for (int i = 0; i < static_cast<int>(std::lround(level.total)); ++i) {
      Trial trial;
      trial.presentation = level.cluster;
      trial.set_delta_t_k = trial.delta_t_k = delta_t_k;
      trial.size_mrad = level.size;
      trial.answer = i < static_cast<int>(std::lround(level.correct)) ? trial.truth : Apex::down;
      trials.push_back(std::move(trial));
    }
  }
  return trials;
}

Result<std::vector<double>> sizes_round_threshold(const SensorSpec& sensor, TemplateObserver& observer,
                                                  const DynamicTrialOptions& options) {
  constexpr int count = 11;
  constexpr double smallest = 0.5, largest = 2.5;
  const double contrast_k = std::abs(options.delta_t_k);
  DirectEstimateOptions estimate{
      .motion = {}, .accuracy = Accuracy::draft(), .seed = options.seed, .stop = options.stop};
  TODBENCH_TRY_VOID(require_square_pixels(sensor, "a trial with a moving target"));
  TODBENCH_TRY(const auto found, direct_estimate(sensor, full_plan(sensor, {}, {}), observer, {contrast_k}, estimate));
  std::vector<double> sizes;
  for (int i = 0; i < count; ++i)
    sizes.push_back(found.front().s75_pitch * smallest * std::pow(largest / smallest, i / (count - 1.0)));
  return sizes;
}

/// Without the ends of the open parameters.
Result<std::vector<DynamicAcuity>> acuities_of(const SensorSpec& sensor, TemplateObserver& observer,
                                               DynamicTrialOptions options) {
  if (options.sizes_pitch.empty()) {
    TODBENCH_TRY(options.sizes_pitch, sizes_round_threshold(sensor, observer, options));
  }
  TODBENCH_TRY(const auto trials, dynamic_trials(sensor, observer, options));
  const FitOptions fit;
  std::vector<DynamicAcuity> found;
  for (const DynamicTrials& moving : trials) {
    DynamicAcuity at = dynamic_acuity_at(sensor, moving.speed_mrad_s, moving.speed_px);
    for (const SequenceObserver kind : all_sequence_observers) {
      const auto k = static_cast<std::size_t>(kind);
      TODBENCH_TRY(auto point, dynamic_point(kind, moving.levels[k], trials_of(moving.levels[k], options.delta_t_k),
                                             trials_of(trials.front().levels[k], options.delta_t_k), fit));
      at.points.push_back(std::move(point));
    }
    found.push_back(std::move(at));
  }
  return found;
}

}  // namespace

DynamicAcuity dynamic_acuity_at(const SensorSpec& sensor, double speed_mrad_s, double speed_px) {
  const SceneMotion motion{.x_mrad_s = speed_mrad_s, .y_mrad_s = 0};
  return {.speed_mrad_s = speed_mrad_s,
          .speed_px = speed_px,
          .smear_px = smear_pitch(sensor, motion).x,
          .exposure_px = exposure_way_pitch(sensor, motion).x,
          .lag_px = mean_lag_pitch(sensor, motion).x,
          .points = {}};
}

Result<DynamicPoint> dynamic_point(SequenceObserver observer, const std::vector<Level>& levels,
                                   const std::vector<Trial>& trials, const std::vector<Trial>& at_rest,
                                   const FitOptions& fit) {
  TODBENCH_TRY(auto fitted, fit_psychometric(levels, fit));
  DynamicPoint point{.observer = observer, .fit = std::move(fitted), .ratio = {}, .ratio_ci95 = {}};
  if (const auto ratios = paired_ratios(trials, at_rest, fit); !ratios.empty()) {
    point.ratio = ratios.front().ratio;
    point.ratio_ci95 = ratios.front().ci95;
  }
  return point;
}

void add_spreads(const std::array<std::vector<DynamicAcuity>, 2>& ends, std::vector<DynamicAcuity>& found) {
  const auto s75 = [](const DynamicPoint& point) { return point.fit.usable() ? point.fit.threshold : std::nullopt; };
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (std::size_t k = 0; k < found[i].points.size(); ++k) {
      DynamicPoint& point = found[i].points[k];
      const DynamicPoint &best = ends[0][i].points[k], &worst = ends[1][i].points[k];
      if (s75(point)) point.s75_spread_mrad = spread_of({s75(best), s75(worst)});
      point.ratio_spread = spread_of({point.ratio, best.ratio, worst.ratio});
    }
  }
}

Result<DynamicAcuities> dynamic_acuity(const SensorSpec& sensor, TemplateObserver& observer,
                                       DynamicTrialOptions options) {
  if (!(std::abs(options.delta_t_k) > 0)) return fail(ErrorCode::invalid_input, "a contrast of 0 K has no threshold");
  std::erase(options.speeds_mrad_s, 0.0);
  options.speeds_mrad_s.insert(options.speeds_mrad_s.begin(), 0);
  TODBENCH_TRY(auto found, acuities_of(sensor, observer, options));
  DynamicAcuities out{std::move(found), {}};
  const auto ends = at_open_ends(observer.spec(), [&](const TemplateObserverSpec& spec) {
    TemplateObserver end(spec, triangle_alternatives());
    return acuities_of(sensor, end, options);
  });
  if (!ends && ends.error().code == ErrorCode::interrupted) return tl::unexpected(ends.error());
  if (!ends) {
    out.notes.push_back("no spread over the observer's open parameters: " + ends.error().message);
  } else if (*ends) {
    add_spreads(**ends, out.speeds);
  }
  return out;
}

}  // namespace todbench
