// Which effects a simulated sensor shows, and why.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "acquisition/core/result.h"
#include "sim_devices/sensor/effect_list.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

enum class Decision { simulate, skip };

struct EffectDecision {
  Effect effect = Effect::diffraction;
  Decision decision = Decision::simulate;
  std::string reason;  ///< a sentence
  std::optional<double>
      predicted_change_percent;  ///< of the 75 % acuity if skipped; nothing where no criterion can promise it
};

/// One decision per effect, in chain order. Data: it is in the configuration, the session folder and the report.
struct SensorPlan {
  std::vector<EffectDecision> decisions;
  [[nodiscard]] bool simulates(Effect effect) const;
};

/// Every effect simulated except those that are neutral in this sensor; then `skip` and `force` are obeyed, and the
/// reasons say so.
[[nodiscard]] SensorPlan full_plan(const SensorSpec& spec, const std::vector<Effect>& skip,
                                   const std::vector<Effect>& force, SceneMotion motion = {});

/// Whether the parameter of the effect has its neutral value in this sensor before this scene.
[[nodiscard]] bool is_neutral(const SensorSpec& spec, Effect effect, SceneMotion motion = {});

/// The sensor with the parameters of all skipped effects at their neutral values: what is simulated. Effects without a
/// neutral value (diffraction, spectral band, detector, quantisation) are asked of the plan.
[[nodiscard]] SensorSpec as_planned(SensorSpec spec, const SensorPlan& plan);

}  // namespace todbench
