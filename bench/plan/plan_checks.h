// What the rest of a plan says against the value of one of its keys.
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
/// Grey levels: no physical measures, which are in kelvin, and no modules behind the camera.
[[nodiscard]] ValueMistakes check_contrast_unit(const Plan& plan, std::size_t row);
/// An address of an instrument; needed for kind scpi.
[[nodiscard]] ValueMistakes check_black_body(const Plan& plan, std::size_t row);
[[nodiscard]] ValueMistakes check_stage(const Plan& plan, std::size_t row);
/// Above 0 for kind display.
[[nodiscard]] ValueMistakes check_display_pixel(const Plan& plan, std::size_t row);
/// Above 0 for kind display, and no contrast beyond it.
[[nodiscard]] ValueMistakes check_display_span(const Plan& plan, std::size_t row);
[[nodiscard]] ValueMistakes check_display_luminance(const Plan& plan, std::size_t row);
/// None of 0 K, none twice.
[[nodiscard]] ValueMistakes check_contrasts(const Plan& plan, std::size_t row);
/// None that is also skipped.
[[nodiscard]] ValueMistakes check_force(const Plan& plan, std::size_t row);
/// More than one only for graded answers: the others are to one frame.
[[nodiscard]] ValueMistakes check_frames_per_presentation(const Plan& plan, std::size_t row);
/// The function of the twin has no lapse; graded answers are not fitted with another.
[[nodiscard]] ValueMistakes check_estimator(const Plan& plan, std::size_t row);
/// Three or more that differ.
[[nodiscard]] ValueMistakes check_transfer_steps(const Plan& plan, std::size_t row);
/// The noise is measured too, in frames enough to tell a pixel that blinks.
[[nodiscard]] ValueMistakes check_pixels(const Plan& plan, std::size_t row);
/// Pixels are measured, and no earlier row has the name.
[[nodiscard]] ValueMistakes check_zone_name(const Plan& plan, std::size_t row);
/// Not empty, and beside those of the rows before but for that of the whole frame.
[[nodiscard]] ValueMistakes check_zone_area(const Plan& plan, std::size_t row);
/// One limit at least.
[[nodiscard]] ValueMistakes check_zone_limits(const Plan& plan, std::size_t row);
/// Not 0 where an MTF is asked for.
[[nodiscard]] ValueMistakes check_mtf_contrast(const Plan& plan, std::size_t row);
[[nodiscard]] ValueMistakes check_ctf_contrast(const Plan& plan, std::size_t row);
/// A step that can be seen, of a target whose settling is known, where a response time is asked for.
[[nodiscard]] ValueMistakes check_response(const Plan& plan, std::size_t row);
/// Among the contrasts of the target, and not in an earlier row.
[[nodiscard]] ValueMistakes check_limit_contrast(const Plan& plan, std::size_t row);
/// Above what the rows of the budget that do not cancel between camera and twin make of a ratio.
[[nodiscard]] ValueMistakes check_margin(const Plan& plan, std::size_t row);
/// One that [measures] asks for, not in an earlier row.
[[nodiscard]] ValueMistakes check_limited_measure(const Plan& plan, std::size_t row);
/// A measure that can be limited, not in an earlier row; an acuity with its contrast.
[[nodiscard]] ValueMistakes check_fleet_measure(const Plan& plan, std::size_t row);
/// Not empty.
[[nodiscard]] ValueMistakes check_module_command(const Plan& plan, std::size_t row);
/// One observer at most, whose answers are not graded; no module where the function of the twin is fitted.
[[nodiscard]] ValueMistakes check_module_place(const Plan& plan, std::size_t row);
/// One or two, with room between them for a value and its stated uncertainty.
[[nodiscard]] ValueMistakes check_measure_limits(const Plan& plan, std::size_t row);
/// A complete budget states every expected row.
[[nodiscard]] ValueMistakes check_require(const Plan& plan, std::size_t row);
/// Not in an earlier row, and no name of a row that a run states itself.
[[nodiscard]] ValueMistakes check_budget_name(const Plan& plan, std::size_t row);
/// A unit of what the row enters, unless a sensitivity converts it.
[[nodiscard]] ValueMistakes check_budget_unit(const Plan& plan, std::size_t row);
/// Of a normal value only.
[[nodiscard]] ValueMistakes check_coverage_factor(const Plan& plan, std::size_t row);
[[nodiscard]] ValueMistakes check_due_date(const Plan& plan, std::size_t row);

/// "YYYY-MM-DD", a day that there is.
[[nodiscard]] std::optional<std::chrono::year_month_day> parse_date(std::string_view text);

}  // namespace todbench
