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
  diffraction,       ///< neutral: no aperture limit
  spectral_band,     ///< diffraction over the band; neutral: its mean wavelength alone
  aberration,        ///< neutral: sigma 0
  detector,          ///< footprint; neutral: point sampling
  motion,            ///< smear of the bolometer's time constant; neutral: time constant 0 or a still target
  microscan,         ///< neutral: 1
  temporal_noise,    ///< neutral: NETD 0
  fixed_pattern,     ///< shared by the samples of a microscan cycle; neutral: sd 0
  row_column_noise,  ///< neutral: both sd 0
  dead_pixels,       ///< neutral: none
  frame_averaging,   ///< neutral: 1 exposure
  super_resolution,  ///< neutral: 0 frames
  display,           ///< reconstruction and blur; neutral: sample and hold, no blur
  quantisation,      ///< neutral: no rounding; counts need it, so a camera always has it
};
inline constexpr std::array all_effects{Effect::diffraction,    Effect::spectral_band,   Effect::aberration,
                                        Effect::detector,       Effect::motion,          Effect::microscan,
                                        Effect::temporal_noise, Effect::fixed_pattern,   Effect::row_column_noise,
                                        Effect::dead_pixels,    Effect::frame_averaging, Effect::super_resolution,
                                        Effect::display,        Effect::quantisation};
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
                                   const std::vector<Effect>& force, SceneMotion motion = {});

/// Whether the parameter of the effect has its neutral value in this sensor before this scene.
[[nodiscard]] bool is_neutral(const SensorSpec& spec, Effect effect, SceneMotion motion = {});

/// The sensor with the parameters of all skipped effects at their neutral values: what is simulated. Diffraction,
/// spectral band, detector and quantisation have no such parameter and are asked of the plan.
[[nodiscard]] SensorSpec as_planned(SensorSpec spec, const SensorPlan& plan);

}  // namespace todbench
