// Which effects a simulated sensor shows, and why.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// The stages of the sensor chain in their order. An effect at its neutral value equals the effect left out, bit for
/// bit.
enum class Effect {
  diffraction,     ///< neutral: no aperture limit
  aberration,      ///< neutral: sigma 0
  detector,        ///< footprint; neutral: point sampling
  temporal_noise,  ///< neutral: NETD 0
  fixed_pattern,   ///< neutral: sd 0
  quantisation,    ///< neutral: no rounding; counts need it, so a camera always has it
};
inline constexpr std::array all_effects{Effect::diffraction,    Effect::aberration,    Effect::detector,
                                        Effect::temporal_noise, Effect::fixed_pattern, Effect::quantisation};
[[nodiscard]] std::string_view to_string(Effect effect);
[[nodiscard]] std::optional<Effect> effect_from(std::string_view name);

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
                                   const std::vector<Effect>& force);

}  // namespace todbench
