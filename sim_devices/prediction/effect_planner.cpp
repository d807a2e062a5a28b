// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/effect_planner.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "acquisition/base/try.h"
#include "sim_devices/prediction/cued_estimate.h"
#include "sim_devices/sensor/effect_display.h"
#include "sim_devices/sensor/effect_quantisation.h"
#include "sim_devices/sensor/effect_row.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

constexpr int planning_wavelengths = 4;
constexpr double budget_share = 0.8;  // of the tolerance; the rest is for numerical errors

/// Variances per sample in units of the contrast squared.
struct NoiseBudget {
  std::array<double, all_effects.size()> by_effect{};
  double white = 0;  ///< noise of the observer included
  double total = 0;
};

/// One contrast with all quantities that the criteria use.
struct Contrast {
  ContrastOutlook outlook;
  NoiseBudget noise;
};

/// Contrasts whose squares would underflow count as 1e-100 K: equally hopeless, but with finite noise.
double squared(double contrast_k) {
  return std::pow(std::max(std::abs(contrast_k), 1e-100), 2);
}

NoiseBudget white_noise(const SensorSpec& sensor, const TemplateObserverSpec& observer, double contrast_k) {
  NoiseBudget noise;
  // The responses contain the edge filter, which raises noise with the signal. Other displays change little.
  const double gain = sensor.edge_boost > 0 ? display_noise_gain(sensor) : 1;
  for (const Effect effect : all_effects) {
    const EffectRow& row = row_of(effect);
    if (row.white_variance_k2 == nullptr) continue;
    const double variance =
        gain * gain * row.white_variance_k2(sensor, observer.sensor_noise_factor) / squared(contrast_k);
    noise.by_effect[static_cast<std::size_t>(effect)] = variance;
    noise.white += variance;
  }
  noise.white += observer.internal_noise * observer.internal_noise;
  noise.total = noise.white;
  return noise;
}

/// Coloured noise counts as the white noise that moves the differences between templates equally.
void add_coloured(NoiseBudget& noise, const SensorSpec& sensor, const SizeTrial& trial, double contrast_k) {
  const NoiseScope scope{.spec = sensor, .contrast_k2 = squared(contrast_k), .variance_ratio = [&](SharedBy shared) {
                           return trial.variance_ratio(shared);
                         }};
  for (const Effect effect : all_effects) {
    const EffectRow& row = row_of(effect);
    if (row.coloured_variance == nullptr) continue;
    const double variance = row.coloured_variance(scope);
    noise.by_effect[static_cast<std::size_t>(effect)] = variance;
    noise.total += variance;
  }
}

Result<Contrast> contrast_of(CuedEstimate& cued, const SensorSpec& sensor, const SensorPlan& everything,
                             const TemplateObserverSpec& observer, double delta_t_k) {
  Contrast out;
  out.outlook.delta_t_k = delta_t_k;
  out.noise = white_noise(sensor, observer, delta_t_k);
  out.outlook.observer_variance = observer.internal_noise * observer.internal_noise;
  cued.show(delta_t_k);
  auto size = cued.s75_pitch(std::sqrt(out.noise.white));
  if (!size) return tl::unexpected(size.error());
  TODBENCH_TRY(const auto trial, cued.trial(*size));
  // Of the eye, as white noise: the estimate above knows its covariance, the budget of the effects a variance.
  const double eye = trial->eye_variance(delta_t_k);
  out.outlook.observer_variance += eye;
  out.noise.white += eye;
  out.noise.total += eye;
  out.outlook.q_eff = std::sqrt(out.noise.white);
  add_coloured(out.noise, sensor, *trial, delta_t_k);
  if (out.noise.total > out.noise.white) {
    size = cued.s75_pitch(std::sqrt(out.noise.total - eye));
    if (!size) return tl::unexpected(size.error());
  }
  TODBENCH_TRY(const auto exponent, cued.sensitivity(std::sqrt(out.noise.total - eye)));
  TODBENCH_TRY(out.outlook.weibull_slope, cued.weibull_slope(std::sqrt(out.noise.total - eye)));
  out.outlook.s75_pitch = *size;
  // The searching observer loses faster than the one that knows the position: its S75 is up to 1.06 times larger at q =
  // 0.3 and 1.12 at 0.7. A factor of 1.5 and an addition of 0.1 keep the bound above it.
  out.outlook.noise_exponent = 1.5 * exponent + 0.1;
  const auto d = [&](double factor) {
    return std::log(discriminability(sensor, everything, factor * *size, planning_wavelengths));
  };
  out.outlook.blur_exponent = (d(1.05) - d(1 / 1.05)) / (2 * std::log(1.05));
  return out;
}

SensorPlan without(SensorPlan plan, Effect effect) {
  for (auto& d : plan.decisions) {
    if (d.effect == effect) d.decision = Decision::skip;
  }
  return plan;
}

/// Change from the ratio of discriminabilities, for blurs without a finite mean square extent.
double discriminability_change(const Contrast& c, const SensorSpec& sensor, const SensorPlan& everything,
                               Effect effect) {
  const double with = discriminability(sensor, everything, c.outlook.s75_pitch, planning_wavelengths);
  const double less = discriminability(sensor, without(everything, effect), c.outlook.s75_pitch, planning_wavelengths);
  return std::abs(std::log(with / less)) / c.outlook.blur_exponent;
}

/// Bound on the change of ln S75 when the effect is skipped at one contrast; empty if there is none.
std::optional<double> bound(Effect effect, const Contrast& c, const SensorSpec& sensor, const SensorPlan& everything,
                            SceneMotion motion) {
  const EffectRow& row = row_of(effect);
  if (row.bound == nullptr) return std::nullopt;
  return row.bound({.spec = sensor,
                    .everything = everything,
                    .motion = motion,
                    .s75_pitch = c.outlook.s75_pitch,
                    .noise_exponent = c.outlook.noise_exponent,
                    .noise_variance = c.noise.by_effect,
                    .total_variance = c.noise.total,
                    .discriminability_change = [&](Effect left_out) {
                      return discriminability_change(c, sensor, everything, left_out);
                    }});
}

struct Candidate {
  std::size_t index = 0;
  double percent = 0;
};

bool contains(const std::vector<Effect>& effects, Effect effect) {
  return std::find(effects.begin(), effects.end(), effect) != effects.end();
}

/// Skips the cheapest candidates as long as the budget lasts. Returns the used part of the budget.
double share_budget(std::vector<Candidate> candidates, double tolerance_percent, SensorPlan& plan) {
  std::sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) { return a.percent < b.percent; });
  const double budget = budget_share * tolerance_percent;
  double used = 0;
  for (const auto& candidate : candidates) {
    auto& decision = plan.decisions[candidate.index];
    if (used + candidate.percent <= budget) {
      used += candidate.percent;
      decision.decision = Decision::skip;
      decision.reason =
          fmt::format("changes the acuity by at most {:.2g} %; skipped effects use {:.2g} % of the {:.3g} % tolerance",
                      candidate.percent, used, tolerance_percent);
    } else {
      decision.reason = fmt::format("may change the acuity by {:.3g} %, more than is left of the {:.3g} % tolerance",
                                    candidate.percent, tolerance_percent);
    }
  }
  return used;
}

void obey(const EffectPlannerOptions& options, EffectPlan& out) {
  for (auto& d : out.plan.decisions) {
    if (contains(options.skip, d.effect)) {
      d.decision = Decision::skip;
      d.on_request = true;
      d.reason = std::string("skipped on request; ") +
                 (d.predicted_change_percent ? fmt::format("predicted change {:.3g} %", *d.predicted_change_percent)
                                             : std::string("no criterion limits the change"));
      out.requested_change_percent += d.predicted_change_percent.value_or(0);
      if (!d.predicted_change_percent)
        out.warnings.push_back("effect " + std::string(to_string(d.effect)) +
                               " is skipped on request: the tolerance is not guaranteed");
    }
    if (contains(options.force, d.effect)) {
      d.decision = Decision::simulate;
      d.on_request = false;
      d.reason = "simulated on request";
    }
  }
  const double together = out.requested_change_percent + out.skipped_change_percent;
  if (out.requested_change_percent > 0 && together > options.tolerance_percent) {
    out.warnings.push_back(fmt::format(
        "effects skipped on request may change the acuity by {:.3g} %: the tolerance of {:.3g} % is not guaranteed",
        out.requested_change_percent, options.tolerance_percent));
  }
}

/// Reason why no bound holds; empty if they hold. Bounds assume normal noise and linear pictures.
std::string why_none_holds(const SensorSpec& sensor, const EffectScene& scene) {
  if (rounds_coarsely(sensor)) {
    return fmt::format(
        "simulated: the noise is {:.2g} counts, so rounding depends on the signal and no criterion applies",
        noise_in_counts(sensor));
  }
  for (const double delta_t_k : scene.delta_t_k) {
    if (reaches_an_end(sensor, delta_t_k, sensor.scene_temperature_k)) {
      return fmt::format("simulated: a contrast of {:g} K reaches the lowest or highest count, so no criterion applies",
                         delta_t_k);
    }
  }
  return "";
}

}  // namespace

SceneSurvey survey_scene(const SensorSpec& sensor, TemplateObserver& observer, const EffectScene& scene) {
  SceneSurvey out{.everything = full_plan(sensor, {}, {}, scene.motion),
                  .change_percent = {},
                  .outlooks = {},
                  .warnings = {},
                  .no_criterion = {}};
  CuedEstimate cued(sensor, out.everything, observer, scene.motion);
  std::vector<Contrast> contrasts;
  for (const double delta_t_k : scene.delta_t_k) {
    auto contrast = contrast_of(cued, sensor, out.everything, observer.spec(), delta_t_k);
    if (contrast) {
      out.outlooks.push_back(contrast->outlook);
      contrasts.push_back(*contrast);
    } else {
      out.warnings.push_back(fmt::format("at {:g} K: ", delta_t_k) + contrast.error().message);
    }
  }
  out.no_criterion = why_none_holds(as_planned(sensor, out.everything), scene);
  for (const auto& decision : out.everything.decisions) {
    std::optional<double> largest;
    if (decision.decision != Decision::skip && out.warnings.empty() && out.no_criterion.empty()) {
      largest = 0.0;
      for (const auto& c : contrasts) {
        const auto change = bound(decision.effect, c, sensor, out.everything, scene.motion);
        largest = change && largest ? std::optional(std::max(*largest, *change)) : std::nullopt;
      }
    }
    // Acuity is 1 / S75: change of the logarithm as a percentage, in the direction of the larger value.
    out.change_percent.push_back(largest ? std::optional(100 * std::expm1(std::min(*largest, 5.0))) : std::nullopt);
  }
  return out;
}

Result<EffectPlan> plan_effects(const SceneSurvey& survey, const EffectPlannerOptions& options) {
  if (survey.outlooks.empty()) {
    return fail(ErrorCode::invalid_input,
                "the plan has no identifiable threshold: " +
                    (survey.warnings.empty() ? std::string("no contrast") : survey.warnings.front()));
  }
  EffectPlan out{.plan = survey.everything,
                 .skipped_change_percent = 0,
                 .requested_change_percent = 0,
                 .outlooks = survey.outlooks,
                 .warnings = survey.warnings};
  const bool one_without_threshold = !survey.warnings.empty();
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < out.plan.decisions.size(); ++i) {
    auto& decision = out.plan.decisions[i];
    if (decision.decision == Decision::skip) continue;  // neutral
    if (one_without_threshold) {
      // Noise may be the reason for a missing threshold: without noise the simulation would find one.
      decision.reason = "simulated: a contrast of the scene has no threshold, so no criterion applies";
      continue;
    }
    if (!survey.no_criterion.empty()) {
      decision.reason = survey.no_criterion;
      continue;
    }
    decision.predicted_change_percent = survey.change_percent[i];
    if (!decision.predicted_change_percent) {
      decision.reason = row_of(decision.effect).always;
      continue;
    }
    if (row_of(decision.effect).when_bounded == WhenBounded::simulated) {
      decision.reason = row_of(decision.effect).always;
      continue;
    }
    if (!contains(options.skip, decision.effect) && !contains(options.force, decision.effect))
      candidates.push_back({i, *decision.predicted_change_percent});
  }
  out.skipped_change_percent = share_budget(std::move(candidates), options.tolerance_percent, out.plan);
  obey(options, out);
  return out;
}

Result<EffectPlan> plan_effects(const SensorSpec& sensor, TemplateObserver& observer, const EffectScene& scene,
                                const EffectPlannerOptions& options) {
  return plan_effects(survey_scene(sensor, observer, scene), options);
}

Result<EffectPlan> EffectPlanner::plan(const SensorSpec& sensor, const TemplateObserverSpec& observer,
                                       const EffectScene& scene, const EffectPlannerOptions& options) {
  constexpr std::size_t most = 8;
  const std::lock_guard lock(mutex_);
  auto at = std::ranges::find_if(known_, [&](const Known& known) {
    return known.sensor == sensor && known.observer == observer && known.scene == scene;
  });
  if (at == known_.end()) {
    TemplateObserver fresh(observer, triangle_alternatives());
    known_.push_front({sensor, observer, scene, survey_scene(sensor, fresh, scene)});
    if (known_.size() > most) known_.pop_back();
    at = known_.begin();
  }
  return plan_effects(at->survey, options);
}

}  // namespace todbench
