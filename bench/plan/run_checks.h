// SPDX-License-Identifier: GPL-3.0-or-later
// Checks of keys of schedule, ramp, simulation and fit against the rest of the plan. Each
// returns the mistakes of the value; its comment states the condition for a correct one.
#pragma once

#include <cstddef>

#include "bench/plan/key_types.h"
#include "bench/plan/plan.h"

namespace todbench {

/// A ramp: instruments or a scene, graded answers with the function of the twin, at least five set-ups.
[[nodiscard]] ValueMistakes check_schedule_kind(const Plan& plan, std::size_t row);
/// A ramp: above 0.
[[nodiscard]] ValueMistakes check_ramp_rate(const Plan& plan, std::size_t row);
/// A ramp: stated.
[[nodiscard]] ValueMistakes check_ramp_from(const Plan& plan, std::size_t row);
/// A ramp: nearer to 0 than from_delta_t_k, of its sign, with the contrasts of the target between both.
[[nodiscard]] ValueMistakes check_ramp_to(const Plan& plan, std::size_t row);
/// A ramp: stated.
[[nodiscard]] ValueMistakes check_contrast_lag(const Plan& plan, std::size_t row);
/// Instruments or a scene, and graded answers with the function of the twin.
[[nodiscard]] ValueMistakes check_settling_band(const Plan& plan, std::size_t row);
/// No effect that is also skipped.
[[nodiscard]] ValueMistakes check_force(const Plan& plan, std::size_t row);
/// More than one frame requires graded answers: other answers use one frame.
[[nodiscard]] ValueMistakes check_frames_per_presentation(const Plan& plan, std::size_t row);
/// The function of the twin excludes a lapse rate; graded answers require the function of the twin.
[[nodiscard]] ValueMistakes check_estimator(const Plan& plan, std::size_t row);

}  // namespace todbench
