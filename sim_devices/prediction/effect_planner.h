// Which effects a scene calls for, decided before anything is simulated.
#pragma once

#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/core/result.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// What will be looked at.
struct EffectScene {
  std::vector<double> delta_t_k;  ///< never 0
  SceneMotion motion{};
  bool operator==(const EffectScene&) const = default;
};

struct EffectPlannerOptions {
  double tolerance_percent = 1;     ///< of the 75 % acuity: what all skipped effects together may change
  std::vector<Effect> skip, force;  ///< obeyed whatever is predicted; the reasons say so
};

/// What is expected at one contrast before simulating.
struct ContrastOutlook {
  double delta_t_k = 0;
  double q_eff = 0;           ///< white noise per sample over the contrast, internal noise included
  double s75_pitch = 0;       ///< of the observer that knows the position
  double noise_exponent = 0;  ///< d ln S75 / d ln q_eff
  double blur_exponent = 0;   ///< d ln D / d ln S
  double weibull_slope = 0;   ///< of the psychometric function at 75 %, of the observer that knows the position
};

struct EffectPlan {
  SensorPlan plan;                        ///< one decision per effect, in the order of the chain
  double skipped_change_percent = 0;      ///< bound on the change by all effects that the criteria skip, together
  double requested_change_percent = 0;    ///< predicted for those skipped on request, where a criterion exists
  std::vector<ContrastOutlook> outlooks;  ///< per contrast of the scene that has a threshold
  std::vector<std::string> warnings;      ///< sentences: contrasts without threshold, skipped effects without criterion
};

/// What the criteria say of a scene whatever the tolerance: all that takes time.
struct SceneSurvey {
  SensorPlan everything;                              ///< every effect that is not neutral
  std::vector<std::optional<double>> change_percent;  ///< per decision: bound on the change; nothing: no criterion
  std::vector<ContrastOutlook> outlooks;              ///< per contrast that has a threshold
  std::vector<std::string> warnings;                  ///< contrasts without, a sentence each
  std::string no_criterion;                           ///< why none holds in this scene; empty: they do
};

/// Deterministic; a tenth of a second for three contrasts, most of it for images and for template banks, which the
/// observer keeps.
[[nodiscard]] SceneSurvey survey_scene(const SensorSpec& sensor, TemplateObserver& observer, const EffectScene& scene);

/// The decisions; the criteria are those of docs/effect-planning.md. The change that skipping an effect makes is
/// bounded at every contrast and the largest is taken. The effects with the smallest bounds are skipped as long as
/// their sum stays within four fifths of the tolerance; the rest is for numerical errors. Detector footprint,
/// microscan, super-resolution and motion by half a pitch and more per time constant have no criterion and are always
/// simulated, and so is everything where a contrast of the scene has no threshold, and where counts are too coarse or
/// too few for the scene. Microseconds. `invalid_input`: no contrast has a threshold.
[[nodiscard]] Result<EffectPlan> plan_effects(const SceneSurvey& survey, const EffectPlannerOptions& options);
/// Survey and decisions together.
[[nodiscard]] Result<EffectPlan> plan_effects(const SensorSpec& sensor, TemplateObserver& observer,
                                              const EffectScene& scene, const EffectPlannerOptions& options);

/// Remembers its latest surveys: plans that differ in nothing but tolerance, requests, trials and the like are planned
/// at once. Thread-safe; what is asked for while a survey is made waits for it.
class EffectPlanner {
 public:
  /// As plan_effects() with a new observer.
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
