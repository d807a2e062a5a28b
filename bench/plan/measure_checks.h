// SPDX-License-Identifier: GPL-3.0-or-later
// Checks of keys of [measures] against the rest of the plan. Each function returns the mistakes in a value. The comment
// of the function states the condition for a correct value. [measures] has no rows, so `row` is 0.
#pragma once

#include <cstddef>

#include "bench/plan/key_types.h"
#include "bench/plan/plan.h"

namespace todbench {

/// Requires at least three different steps.
[[nodiscard]] ValueMistakes check_transfer_steps(const Plan& plan, std::size_t row);
/// Requires a noise measurement with enough frames to detect blinking pixels.
[[nodiscard]] ValueMistakes check_pixels(const Plan& plan, std::size_t row);
/// Requires a contrast other than 0 if an MTF is requested.
[[nodiscard]] ValueMistakes check_mtf_contrast(const Plan& plan, std::size_t row);
/// Requires a contrast other than 0 if a CTF is requested.
[[nodiscard]] ValueMistakes check_ctf_contrast(const Plan& plan, std::size_t row);
/// Requires a contrast other than 0 if the size-of-source effect is requested.
[[nodiscard]] ValueMistakes check_source_size_contrast(const Plan& plan, std::size_t row);
/// Requires three different temperatures in the range of a black body, if absolute temperatures are requested.
[[nodiscard]] ValueMistakes check_absolute_temperatures(const Plan& plan, std::size_t row);
/// Requires a target that is not a monitor, if an MRTD is requested.
[[nodiscard]] ValueMistakes check_mrtd(const Plan& plan, std::size_t row);
/// Requires at least three different contrasts, each stated once, if an MRTD is requested.
[[nodiscard]] ValueMistakes check_mrtd_contrasts(const Plan& plan, std::size_t row);
/// Requires, if a response time is requested, a step large enough to observe and a target with a known settling time.
[[nodiscard]] ValueMistakes check_response(const Plan& plan, std::size_t row);

}  // namespace todbench
