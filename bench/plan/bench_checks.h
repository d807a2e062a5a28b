// SPDX-License-Identifier: GPL-3.0-or-later
// Checks of keys of camera, target, instruments and modules against the rest of the plan. Each function returns the
// mistakes in a value; its comment states the condition for a correct value. `row`: of a repeated section, otherwise 0.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string_view>

#include "bench/plan/key_types.h"
#include "bench/plan/plan.h"

namespace todbench {

/// Requires SCHEME:NAME, or an empty id.
[[nodiscard]] ValueMistakes check_camera_id(const Plan& plan, std::size_t row);
/// Requires WIDTHxHEIGHT in pixels, or an empty text.
[[nodiscard]] ValueMistakes check_frame_size(const Plan& plan, std::size_t row);
/// Requires the address of an instrument for kind scpi.
[[nodiscard]] ValueMistakes check_black_body(const Plan& plan, std::size_t row);
/// Requires the address of an instrument for kind scpi.
[[nodiscard]] ValueMistakes check_stage(const Plan& plan, std::size_t row);
/// Requires a number above 0 for kind display.
[[nodiscard]] ValueMistakes check_display_pixel(const Plan& plan, std::size_t row);
/// Requires, for kind display, a number above 0 and at least the largest contrast.
[[nodiscard]] ValueMistakes check_display_span(const Plan& plan, std::size_t row);
/// Requires at least two luminances in rising order. With more than two, display_gamma must not be stated.
[[nodiscard]] ValueMistakes check_display_luminance(const Plan& plan, std::size_t row);
/// Requires kelvin if the plan requests physical measures in kelvin (all but the gain control) or has modules after the
/// camera.
[[nodiscard]] ValueMistakes check_contrast_unit(const Plan& plan, std::size_t row);
/// Requires contrasts other than 0 K, without duplicates.
[[nodiscard]] ValueMistakes check_contrasts(const Plan& plan, std::size_t row);
/// Requires one number, or one for each plate, each at most the number of mountings.
[[nodiscard]] ValueMistakes check_mountings_per_plate(const Plan& plan, std::size_t row);
/// Requires the focal length of the collimator, if there is one.
[[nodiscard]] ValueMistakes check_distance(const Plan& plan, std::size_t row);
/// Requires a focal length if another key of the collimator is stated, and no collimator in front of a monitor.
[[nodiscard]] ValueMistakes check_focal_length(const Plan& plan, std::size_t row);
/// Requires equal numbers of wavelengths and transmissions, and wavelengths in rising order.
[[nodiscard]] ValueMistakes check_collimator_table(const Plan& plan, std::size_t row);
/// Requires "YYYY-MM-DD", or an empty text.
[[nodiscard]] ValueMistakes check_due_date(const Plan& plan, std::size_t row);
/// Requires a command that is not empty.
[[nodiscard]] ValueMistakes check_module_command(const Plan& plan, std::size_t row);
/// Requires at most one module with place observer, binary answers if there is such a module, and no module if the
/// function of the twin is fitted.
[[nodiscard]] ValueMistakes check_module_place(const Plan& plan, std::size_t row);

/// Parses "YYYY-MM-DD"; empty if the text is not an existing day.
[[nodiscard]] std::optional<std::chrono::year_month_day> parse_date(std::string_view text);

}  // namespace todbench
