// SPDX-License-Identifier: GPL-3.0-or-later
// A target whose black body has an absolute set-point.
#pragma once

#include <array>
#include <stop_token>

#include "acquisition/base/result.h"
#include "tod/presentation/target.h"

namespace todbench {

/// Additional interface of a Target that shows a black body at an absolute temperature. Use it only from the thread of
/// the Target.
class AbsoluteTarget {
 public:
  virtual ~AbsoluteTarget() = default;
  /// Returns the lowest and the highest temperature. Errors: `invalid_input` (the black body has no absolute set-point,
  /// or its reading is in a different unit than its table states), `disconnected`, `interrupted`.
  [[nodiscard]] virtual Result<std::array<double, 2>> temperatures_k(std::stop_token stop) = 0;
  /// Presents a state like Target::present(), with the black body at `temperature_k`. `state.delta_t_k` is ignored. The
  /// measured temperature is PresentedTarget::black_body_temperature_k.
  [[nodiscard]] virtual Result<PresentedTarget> present_temperature(const TargetState& state, double temperature_k,
                                                                    std::stop_token stop) = 0;
};

/// Returns the same target if it implements AbsoluteTarget, otherwise null. The pointer is valid as long as the target.
[[nodiscard]] inline AbsoluteTarget* absolute_target(Target& target) {
  return dynamic_cast<AbsoluteTarget*>(&target);
}

}  // namespace todbench
