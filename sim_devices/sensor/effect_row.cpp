// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/effect_row.h"

#include <algorithm>
#include <cmath>

namespace todbench {
namespace {

#define TODBENCH_EFFECT_NAME(name) std::string_view(#name),
constexpr std::array names{TODBENCH_EFFECTS(TODBENCH_EFFECT_NAME)};
#undef TODBENCH_EFFECT_NAME

}  // namespace

std::string_view to_string(Effect effect) {
  return names[static_cast<std::size_t>(effect)];
}

std::optional<Effect> effect_from(std::string_view name) {
  const auto at = std::ranges::find(names, name);
  if (at == names.end()) return std::nullopt;
  return static_cast<Effect>(at - names.begin());
}

const EffectRow& row_of(Effect effect) {
#define TODBENCH_EFFECT_ROW(name) effect_rows::name(),
  static const std::array<EffectRow, all_effects.size()> rows{TODBENCH_EFFECTS(TODBENCH_EFFECT_ROW)};
#undef TODBENCH_EFFECT_ROW
  return rows[static_cast<std::size_t>(effect)];
}

double white_variance_k2(const SensorSpec& spec, const SensorPlan& plan, double noise_factor) {
  double sum = 0;
  for (const Effect effect : all_effects) {
    const EffectRow& row = row_of(effect);
    if (row.white_variance_k2 != nullptr && plan.simulates(effect)) sum += row.white_variance_k2(spec, noise_factor);
  }
  return sum;
}

double ExpectedScene::noise_change(double variance_change) const {
  const double share = std::max(variance_change / total_variance, -1 + 1e-9);
  return std::abs(noise_exponent * 0.5 * std::log1p(share));
}

}  // namespace todbench
