// SPDX-License-Identifier: GPL-3.0-or-later
// Effects that a simulated sensor shows, with reasons.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "sim_devices/sensor/effect_list.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Whether the plan simulates an effect.
enum class Decision { simulate, skip };

struct EffectDecision {
  Effect effect = Effect::diffraction;
  Decision decision = Decision::simulate;
  std::string reason;  ///< a sentence
  /// Change of the 75 % acuity if the effect is skipped; empty if no criterion bounds it.
  std::optional<double> predicted_change_percent;
  bool on_request = false;  ///< true if the list `skip` names the effect; it is then skipped regardless of the change
  /// Returns whether the effect is skipped without any change of the sensor.
  [[nodiscard]] bool changes_nothing() const { return decision == Decision::skip && predicted_change_percent == 0.0; }
};

/// One decision per effect, in chain order. Part of the configuration, the session folder and the report.
struct SensorPlan {
  std::vector<EffectDecision> decisions;
  /// Returns whether the effect is simulated.
  [[nodiscard]] bool simulates(Effect effect) const;
};

/// Returns the plan that simulates every effect that is not neutral in this sensor. The lists `skip` and `force`
/// override this rule; the reasons of the decisions then state the request.
[[nodiscard]] SensorPlan full_plan(const SensorSpec& spec, const std::vector<Effect>& skip,
                                   const std::vector<Effect>& force, SceneMotion motion = {});

/// Returns whether the parameters of the effect are neutral in this sensor with this motion.
[[nodiscard]] bool is_neutral(const SensorSpec& spec, Effect effect, SceneMotion motion = {});

/// Returns the simulated sensor: parameters of all skipped effects have their neutral values. The stages of effects
/// without a neutral value (diffraction, spectral band, detector, quantisation) read the plan.
[[nodiscard]] SensorSpec as_planned(SensorSpec spec, const SensorPlan& plan);

}  // namespace todbench
