// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/twin/acuity_limits.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/plan/descriptions.h"
#include "bench/twin/direct_results.h"
#include "bench/twin/module_chain.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

/// A sensor and an observer, with the options of their estimate.
struct ViewedSensor {
  SensorSpec sensor;
  SensorPlan effects;
  TemplateObserverSpec observer;
  DirectEstimateOptions options;
};

constexpr Effect noise_effects[] = {Effect::temporal_noise, Effect::correlated_noise, Effect::fixed_pattern,
                                    Effect::row_column_noise, Effect::quantisation};

void skip(SensorPlan& plan, Effect effect) {
  for (auto& decision : plan.decisions) {
    if (decision.effect == effect) decision.decision = Decision::skip;
  }
}

void leave_out_sampling(ViewedSensor& viewed) {
  viewed.options.samples_per_pitch = 2 * viewed.sensor.samples_per_pitch();
  if (viewed.observer.display) {
    viewed.observer.display->pixel_pitch_mm = pixel_pitch_mm(*viewed.observer.display) / 2;
    viewed.observer.display->diagonal_in = 0;
    viewed.observer.display->pixels.clear();
  } else {
    viewed.observer.blur_sigma_samples *= 2;
  }
}

void leave_out_display(ViewedDisplay& display) {
  display.spot_mm = 0;
  display.veil_cd_m2 = 0;
  display.interpolation = DisplayInterpolation::hold;
  if (display.luminance_table.empty()) {
    display.luminance_white_cd_m2 += display.luminance_black_cd_m2;  // the middle of the range stays
    display.luminance_black_cd_m2 = 0;
  }
  display.span_k = 0;
  display.contrast = largest_contrast(display);
}

void brighten(ViewedDisplay& display) {
  constexpr double factor = 100;
  display.luminance_white_cd_m2 *= factor;
  display.luminance_black_cd_m2 *= factor;
  display.veil_cd_m2 *= factor;
  for (double& luminance : display.luminance_table) luminance *= factor;
}

/// False if the observer does not have the factor.
bool leave_out(LimitingFactor factor, ViewedSensor& viewed) {
  TemplateObserverSpec& observer = viewed.observer;
  switch (factor) {
    case LimitingFactor::sampling:
      leave_out_sampling(viewed);
      return true;
    case LimitingFactor::sensor_noise:
      for (const Effect effect : noise_effects) skip(viewed.effects, effect);
      viewed.sensor = as_planned(viewed.sensor, viewed.effects);
      return true;
    case LimitingFactor::display:
      if (!observer.display) return false;
      leave_out_display(*observer.display);
      return true;
    case LimitingFactor::eye:
      if (!observer.eye) return false;
      observer.eye->sensitivity *= 1000;
      observer.eye->contrast_noise = 0;
      observer.sensor_noise_factor = 1;
      return true;
    case LimitingFactor::observer:
      if (observer.eye) return false;
      observer.blur_sigma_samples = 0.1;
      observer.internal_noise = 0;
      observer.sensor_noise_factor = 1;
      return true;
    case LimitingFactor::light:
      if (!observer.display) return false;
      brighten(*observer.display);
      return true;
  }
  return false;
}

Result<double> s75_of(const ViewedSensor& viewed, double delta_t_k) {
  TemplateObserver observer(viewed.observer, triangle_alternatives());
  TODBENCH_TRY(const auto points,
               direct_estimate(viewed.sensor, viewed.effects, observer, {delta_t_k}, viewed.options));
  return points.front().s75_pitch;
}

}  // namespace

Result<std::vector<AcuityLimits>> acuity_limits(const Plan& plan, const ExperimentInputs& inputs,
                                                const std::vector<double>& delta_t_k, std::stop_token stop) {
  if (has_modules(plan, inputs.sensor))
    return fail(ErrorCode::invalid_input,
                "What limits the acuity is not known, because the estimates do not include the modules of the plan or "
                "of its sensor");
  ViewedSensor all{inputs.sensor, inputs.effects, inputs.observer, {}};
  all.options.motion = inputs.motion;
  all.options.accuracy = Accuracy::draft();
  all.options.stop = std::move(stop);
  std::vector<AcuityLimits> found;
  for (const double contrast : delta_t_k) {
    const auto s75 = s75_of(all, contrast);
    if (!s75 && s75.error().code == ErrorCode::interrupted) return tl::unexpected(s75.error());
    if (!s75) continue;
    AcuityLimits limits{.delta_t_k = contrast, .s75_mrad = *s75 * inputs.sensor.ifov_mrad(), .costs = {}};
    for (const LimitingFactor factor : all_limiting_factors) {
      ViewedSensor viewed = all;
      if (!leave_out(factor, viewed)) continue;
      const auto without = s75_of(viewed, contrast);
      if (!without && without.error().code == ErrorCode::interrupted) return tl::unexpected(without.error());
      if (without) limits.costs.push_back({factor, 100 * (*s75 / *without - 1)});
    }
    std::ranges::stable_sort(limits.costs, std::ranges::greater(), &FactorCost::percent);
    found.push_back(std::move(limits));
  }
  return found;
}

Result<std::optional<DisplayRecord>> at_display(const TodCurve& curve, const ExperimentInputs& inputs, const Plan& plan,
                                                std::stop_token stop) {
  if (has_modules(plan, inputs.sensor) || !(inputs.observer.eye || plan.display_as_operator)) return std::nullopt;
  ExperimentInputs viewed = inputs;
  DisplayRecord record;
  if (!inputs.observer.eye) {
    TODBENCH_TRY(viewed.observer, load_observer_at("hvs-2", plan.display));
    const DirectResults direct = direct_results(curve, viewed, {}, plan.seed, stop);
    if (direct.ended_by) return tl::unexpected(*direct.ended_by);
    const double ifov_mrad = inputs.sensor.ifov_mrad();
    for (const auto& [contrast, point] : direct.points) {
      DisplayedPoint shown{.delta_t_k = contrast, .s75_mrad = point.s75_pitch * ifov_mrad};
      if (const auto spread = direct.spread_pitch.find(contrast); spread != direct.spread_pitch.end())
        shown.spread_mrad = {spread->second.first * ifov_mrad, spread->second.second * ifov_mrad};
      record.points.push_back(shown);
    }
  }
  record.observer = viewed.observer.name;
  std::vector<double> contrasts;
  for (const TodPoint& point : curve.points) contrasts.push_back(point.delta_t_k);
  TODBENCH_TRY(record.limits, acuity_limits(plan, viewed, contrasts, std::move(stop)));
  return record;
}

}  // namespace todbench
