// SPDX-License-Identifier: GPL-3.0-or-later
// Checks of keys of camera, target, instruments and modules against the rest of the plan. Each
// returns the mistakes of the value; its comment states the condition for a correct one.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string_view>

#include "bench/plan/key_types.h"
#include "bench/plan/plan.h"

namespace todbench {

/// SCHEME:NAME, or empty.
[[nodiscard]] ValueMistakes check_camera_id(const Plan& plan, std::size_t row);
[[nodiscard]] ValueMistakes check_frame_size(const Plan& plan, std::size_t row);
/// Address of an instrument; required for kind scpi.
[[nodiscard]] ValueMistakes check_black_body(const Plan& plan, std::size_t row);
[[nodiscard]] ValueMistakes check_stage(const Plan& plan, std::size_t row);
/// Above 0 for kind display.
[[nodiscard]] ValueMistakes check_display_pixel(const Plan& plan, std::size_t row);
/// Above 0 for kind display, and at least the largest contrast.
[[nodiscard]] ValueMistakes check_display_span(const Plan& plan, std::size_t row);
[[nodiscard]] ValueMistakes check_display_luminance(const Plan& plan, std::size_t row);
/// Grey levels exclude physical measures in kelvin (all but the gain control) and modules behind the camera.
[[nodiscard]] ValueMistakes check_contrast_unit(const Plan& plan, std::size_t row);
/// No contrast of 0 K, no duplicates.
[[nodiscard]] ValueMistakes check_contrasts(const Plan& plan, std::size_t row);
/// One number, or one for each plate; at most the number of mountings.
[[nodiscard]] ValueMistakes check_mountings_per_plate(const Plan& plan, std::size_t row);
/// The focal length of the collimator, if there is one.
[[nodiscard]] ValueMistakes check_distance(const Plan& plan, std::size_t row);
/// The other keys of the collimator need a focal length; no collimator before a monitor.
[[nodiscard]] ValueMistakes check_focal_length(const Plan& plan, std::size_t row);
/// As many wavelengths as transmissions, in rising order.
[[nodiscard]] ValueMistakes check_collimator_table(const Plan& plan, std::size_t row);
[[nodiscard]] ValueMistakes check_due_date(const Plan& plan, std::size_t row);
/// Not empty.
[[nodiscard]] ValueMistakes check_module_command(const Plan& plan, std::size_t row);
/// At most one observer, and without graded answers; no module if the function of the twin is fitted.
[[nodiscard]] ValueMistakes check_module_place(const Plan& plan, std::size_t row);

/// Parses "YYYY-MM-DD"; empty if the text is not an existing day.
[[nodiscard]] std::optional<std::chrono::year_month_day> parse_date(std::string_view text);

}  // namespace todbench
