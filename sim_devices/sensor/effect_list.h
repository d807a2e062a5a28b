// SPDX-License-Identifier: GPL-3.0-or-later
// Table of the effects, in the order of the sensor chain. The file effect_NAME.cpp defines the row of each effect.
#pragma once

#include <array>
#include <optional>
#include <string_view>

// NOLINTBEGIN(cppcoreguidelines-macro-usage)
#define TODBENCH_EFFECTS(EFFECT) \
  EFFECT(turbulence)             \
  EFFECT(image_dance)            \
  EFFECT(diffraction)            \
  EFFECT(spectral_band)          \
  EFFECT(aberration)             \
  EFFECT(halo)                   \
  EFFECT(distortion)             \
  EFFECT(detector)               \
  EFFECT(motion)                 \
  EFFECT(exposure)               \
  EFFECT(readout)                \
  EFFECT(microscan)              \
  EFFECT(temporal_noise)         \
  EFFECT(correlated_noise)       \
  EFFECT(fixed_pattern)          \
  EFFECT(row_column_noise)       \
  EFFECT(dead_pixels)            \
  EFFECT(frame_averaging)        \
  EFFECT(super_resolution)       \
  EFFECT(display)                \
  EFFECT(quantisation)
// NOLINTEND(cppcoreguidelines-macro-usage)

namespace todbench {

/// An effect of the sensor chain, described by its row (effect_row.h). An effect at its neutral value gives the same
/// result as an omitted effect, bit for bit.
#define TODBENCH_EFFECT_NAME(name) name,
enum class Effect { TODBENCH_EFFECTS(TODBENCH_EFFECT_NAME) };
#undef TODBENCH_EFFECT_NAME

#define TODBENCH_EFFECT_NAME(name) Effect::name,
inline constexpr std::array all_effects{TODBENCH_EFFECTS(TODBENCH_EFFECT_NAME)};
#undef TODBENCH_EFFECT_NAME

/// Returns the name in plans, options and files, which equals the name of the enumerator.
[[nodiscard]] std::string_view to_string(Effect effect);
/// Returns the effect with this name; empty if there is none.
[[nodiscard]] std::optional<Effect> effect_from(std::string_view name);

}  // namespace todbench
