// SPDX-License-Identifier: GPL-3.0-or-later
// Checks of a key against the rest of the plan. Each returns the mistakes of the value; its comment states the
// condition for a correct one.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "bench/plan/key_types.h"
#include "bench/plan/plan.h"

namespace todbench {

using ValueMistakes = std::vector<ValueMistake>;

/// SCHEME:NAME, or empty.
[[nodiscard]] ValueMistakes check_camera_id(const Plan& plan, std::size_t row);
[[nodiscard]] ValueMistakes check_frame_size(const Plan& plan, std::size_t row);
/// Grey levels exclude physical measures in kelvin (all but the gain control) and modules behind the camera.
[[nodiscard]] ValueMistakes check_contrast_unit(const Plan& plan, std::size_t row);
/// Address of an instrument; required for kind scpi.
[[nodiscard]] ValueMistakes check_black_body(const Plan& plan, std::size_t row);
[[nodiscard]] ValueMistakes check_stage(const Plan& plan, std::size_t row);
/// Above 0 for kind display.
[[nodiscard]] ValueMistakes check_display_pixel(const Plan& plan, std::size_t row);
/// Above 0 for kind display, and at least the largest contrast.
[[nodiscard]] ValueMistakes check_display_span(const Plan& plan, std::size_t row);
[[nodiscard]] ValueMistakes check_display_luminance(const Plan& plan, std::size_t row);
/// One number, or one for each plate; at most the number of mountings.
[[nodiscard]] ValueMistakes check_mountings_per_plate(const Plan& plan, std::size_t row);
/// No contrast of 0 K, no duplicates.
[[nodiscard]] ValueMistakes check_contrasts(const Plan& plan, std::size_t row);
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
/// At least three different steps.
[[nodiscard]] ValueMistakes check_transfer_steps(const Plan& plan, std::size_t row);
/// Requires noise measurement with enough frames to detect blinking pixels.
[[nodiscard]] ValueMistakes check_pixels(const Plan& plan, std::size_t row);
/// Requires the pixel check and a name that no earlier row has.
[[nodiscard]] ValueMistakes check_zone_name(const Plan& plan, std::size_t row);
/// Not empty, and without overlap with earlier rows, except the zone of the whole frame.
[[nodiscard]] ValueMistakes check_zone_area(const Plan& plan, std::size_t row);
/// At least one limit.
[[nodiscard]] ValueMistakes check_zone_limits(const Plan& plan, std::size_t row);
/// Not 0 if an MTF is requested.
[[nodiscard]] ValueMistakes check_mtf_contrast(const Plan& plan, std::size_t row);
[[nodiscard]] ValueMistakes check_ctf_contrast(const Plan& plan, std::size_t row);
[[nodiscard]] ValueMistakes check_source_size_contrast(const Plan& plan, std::size_t row);
/// Three different temperatures in the range of a black body, if absolute temperatures are requested.
[[nodiscard]] ValueMistakes check_absolute_temperatures(const Plan& plan, std::size_t row);
/// The focal length of the collimator, if there is one.
[[nodiscard]] ValueMistakes check_distance(const Plan& plan, std::size_t row);
/// The other keys of the collimator need a focal length; no collimator before a monitor.
[[nodiscard]] ValueMistakes check_focal_length(const Plan& plan, std::size_t row);
/// As many wavelengths as transmissions, in rising order.
[[nodiscard]] ValueMistakes check_collimator_table(const Plan& plan, std::size_t row);
[[nodiscard]] ValueMistakes check_mrtd(const Plan& plan, std::size_t row);
[[nodiscard]] ValueMistakes check_mrtd_contrasts(const Plan& plan, std::size_t row);
/// If a response time is requested: a step large enough to observe, and a target with a known settling time.
[[nodiscard]] ValueMistakes check_response(const Plan& plan, std::size_t row);
/// One of the contrasts of the target, not in an earlier row.
[[nodiscard]] ValueMistakes check_limit_contrast(const Plan& plan, std::size_t row);
/// Above the uncertainty of a ratio from the budget rows that do not cancel between camera and twin.
[[nodiscard]] ValueMistakes check_margin(const Plan& plan, std::size_t row);
/// A measure that [measures] requests, not in an earlier row.
[[nodiscard]] ValueMistakes check_limited_measure(const Plan& plan, std::size_t row);
/// A measure that can have a limit, not in an earlier row; an acuity needs its contrast.
[[nodiscard]] ValueMistakes check_fleet_measure(const Plan& plan, std::size_t row);
/// Not empty.
[[nodiscard]] ValueMistakes check_module_command(const Plan& plan, std::size_t row);
/// At most one observer, and without graded answers; no module if the function of the twin is fitted.
[[nodiscard]] ValueMistakes check_module_place(const Plan& plan, std::size_t row);
/// One or two limits, with room between them for a value and its stated uncertainty.
[[nodiscard]] ValueMistakes check_measure_limits(const Plan& plan, std::size_t row);
/// A budget with `require` states every expected row.
[[nodiscard]] ValueMistakes check_require(const Plan& plan, std::size_t row);
/// Not in an earlier row, and not the name of a row that a run adds.
[[nodiscard]] ValueMistakes check_budget_name(const Plan& plan, std::size_t row);
/// A unit that fits the input of the row, unless a sensitivity converts it.
[[nodiscard]] ValueMistakes check_budget_unit(const Plan& plan, std::size_t row);
/// Only for a normal distribution.
[[nodiscard]] ValueMistakes check_coverage_factor(const Plan& plan, std::size_t row);
[[nodiscard]] ValueMistakes check_due_date(const Plan& plan, std::size_t row);

/// Parses "YYYY-MM-DD"; empty if the text is not an existing day.
[[nodiscard]] std::optional<std::chrono::year_month_day> parse_date(std::string_view text);

}  // namespace todbench
