// SPDX-License-Identifier: GPL-3.0-or-later
// Planner that decides before a simulation which effects a scene needs.
#pragma once

#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Contrasts and motion of the scene that will be observed.
struct EffectScene {
  std::vector<double> delta_t_k;  ///< contrasts in kelvin, not 0
  SceneMotion motion{};
  bool operator==(const EffectScene&) const = default;
};

/// Options of the planner.
struct EffectPlannerOptions {
  double tolerance_percent = 1;     ///< allowed change of the 75 % acuity by all skipped effects together
  std::vector<Effect> skip, force;  ///< override the prediction; the reasons of the decisions state the request
};

/// Prediction at one contrast before the simulation.
struct ContrastOutlook {
  double delta_t_k = 0;
  double q_eff = 0;              ///< q: white noise per sample over the contrast, internal noise included
  double s75_pitch = 0;          ///< 75 % size of the observer that knows the position
  double noise_exponent = 0;     ///< d ln S75 / d ln q_eff
  double blur_exponent = 0;      ///< d ln D / d ln S: discriminability (cued_estimate.h) over target size
  double observer_variance = 0;  ///< share of the observer's own noise (internal, or of the eye) in q_eff squared
  double weibull_slope = 0;  ///< slope of the psychometric function of the observer that knows the position, at 75 %
};

/// Decisions of the planner, with the predictions on which they are based.
struct EffectPlan {
  SensorPlan plan;                        ///< one decision per effect, in chain order
  double skipped_change_percent = 0;      ///< bound on the change by all effects together that the criteria skip
  double requested_change_percent = 0;    ///< predicted change by effects skipped on request that have a criterion
  std::vector<ContrastOutlook> outlooks;  ///< for each contrast with a threshold
  std::vector<std::string> warnings;      ///< sentences: contrasts without threshold, skipped effects without criterion
};

/// Results of the criteria for a scene, independent of the tolerance: the part of the planning that takes time.
struct SceneSurvey {
  SensorPlan everything;                              ///< every effect that is not neutral
  std::vector<std::optional<double>> change_percent;  ///< bound on the change for each decision; empty: no criterion
  std::vector<ContrastOutlook> outlooks;              ///< for each contrast with a threshold
  std::vector<std::string> warnings;                  ///< a sentence for each contrast without threshold
  std::string no_criterion;                           ///< reason if no criterion holds in this scene; otherwise empty
};

/// Evaluates the criteria. Deterministic. Takes a tenth of a second for three contrasts, most of it for images and for
/// template banks, which the observer keeps.
[[nodiscard]] SceneSurvey survey_scene(const SensorSpec& sensor, TemplateObserver& observer, const EffectScene& scene);

/// Decides which effects are skipped, by the criteria of docs/method/effect-planning.md. For each contrast, a criterion
/// gives an upper bound of the change of S75 that results from skipping an effect. The largest of these bounds is used.
/// The effects with the smallest bounds are skipped as long as their sum is within four fifths of the tolerance. The
/// rest of the tolerance is reserved for numerical errors. Detector footprint, microscan, super-resolution and motion
/// by half a pitch or more per time constant have no criterion and are always simulated. All effects are simulated if a
/// contrast of the scene has no threshold, or if counts are too coarse or too few. Takes microseconds. Errors:
/// `invalid_input` (no contrast has a threshold).
[[nodiscard]] Result<EffectPlan> plan_effects(const SceneSurvey& survey, const EffectPlannerOptions& options);
/// Runs survey_scene() and plan_effects() on its result.
[[nodiscard]] Result<EffectPlan> plan_effects(const SensorSpec& sensor, TemplateObserver& observer,
                                              const EffectScene& scene, const EffectPlannerOptions& options);

/// Planner that caches its latest surveys, so it plans immediately if only tolerance, requests or trials differ from a
/// cached survey. Thread-safe; a request that arrives during a survey waits for the survey.
class EffectPlanner {
 public:
  /// Plans the effects as plan_effects() does, with a new observer.
  [[nodiscard]] Result<EffectPlan> plan(const SensorSpec& sensor, const TemplateObserverSpec& observer,
                                        const EffectScene& scene, const EffectPlannerOptions& options);

 private:
  struct Known {
    SensorSpec sensor;
    TemplateObserverSpec observer;
    EffectScene scene;
    SceneSurvey survey;
  };
  std::mutex mutex_;
  std::deque<Known> known_;  ///< the latest first
};

}  // namespace todbench
