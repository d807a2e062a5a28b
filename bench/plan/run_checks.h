// SPDX-License-Identifier: GPL-3.0-or-later
// Checks of keys of schedule, ramp, simulation and fit against the rest of the plan. Each function returns the mistakes
// in a value; its comment states the condition for a correct value. `row`: row of a repeated section, otherwise 0.
#pragma once

#include <cstddef>

#include "bench/plan/key_types.h"
#include "bench/plan/plan.h"

namespace todbench {

/// If the schedule is a ramp, requires instruments or a scene, graded answers with the function of the twin, and at
/// least five set-ups.
[[nodiscard]] ValueMistakes check_schedule_kind(const Plan& plan, std::size_t row);
/// Checks that the rate of a ramp is above 0.
[[nodiscard]] ValueMistakes check_ramp_rate(const Plan& plan, std::size_t row);
/// Requires a stated value if the schedule is a ramp.
[[nodiscard]] ValueMistakes check_ramp_from(const Plan& plan, std::size_t row);
/// If the schedule is a ramp, requires a value nearer to 0 than from_delta_t_k, of the same sign, and all contrasts
/// of the target between both values.
[[nodiscard]] ValueMistakes check_ramp_to(const Plan& plan, std::size_t row);
/// Requires a stated value if the schedule is a ramp.
[[nodiscard]] ValueMistakes check_contrast_lag(const Plan& plan, std::size_t row);
/// Requires instruments or a scene, and graded answers with the function of the twin.
[[nodiscard]] ValueMistakes check_settling_band(const Plan& plan, std::size_t row);
/// Requires effects that are not also skipped.
[[nodiscard]] ValueMistakes check_force(const Plan& plan, std::size_t row);
/// Requires graded answers for more than one frame, because other answers use one frame.
[[nodiscard]] ValueMistakes check_frames_per_presentation(const Plan& plan, std::size_t row);
/// Requires no lapse rate with the function of the twin, and the function of the twin for graded answers.
[[nodiscard]] ValueMistakes check_estimator(const Plan& plan, std::size_t row);

}  // namespace todbench
