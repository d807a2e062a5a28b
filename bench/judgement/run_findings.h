// SPDX-License-Identifier: GPL-3.0-or-later
// Findings about a run: effective contrast against set contrast, and changes of the camera.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/plan/plan.h"
#include "tod/measurement/contrast_error.h"
#include "tod/measurement/run_constancy.h"
#include "tod/presentation/presentation.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Relative standard uncertainty of the contrast estimate itself. The estimates are corrected for the blur of the
/// simulated camera. The effect of the real blur differs by up to 2.6 % (observed; half-width of a rectangular
/// distribution).
inline constexpr double reading_relative_u = 0.015;
/// Relative standard uncertainty of black body and camera scale together if the plan has no budget for either: 2 % for
/// each, and 1 % for the emissivity.
inline constexpr double assumed_relative_u = 0.03;
/// Probability of a false alarm over all contrasts of a run.
inline constexpr double contrast_false_alarm = 0.005;

/// Returns the largest relative deviation of the effective contrast from the set contrast that is allowed:
/// max_contrast_deviation_percent of the plan. If the plan does not state this value, the allowed deviation is
/// Student's t times the combined standard uncertainty of the contrast rows of the budget, the estimate, and the
/// effective contrast itself. `contrasts`: number of tested contrasts.
[[nodiscard]] double allowed_contrast_deviation(const Plan& plan, const TodPoint& point, std::size_t contrasts);

/// Relative deviation of the contrast above which the run ends, because all its results would be meaningless.
inline constexpr double gross_contrast_deviation = 1.0 / 3;
/// Returns MeasurementOptions::max_contrast_error: the larger of gross_contrast_deviation and
/// allowed_contrast_deviation(). Empty for contrasts in grey levels.
[[nodiscard]] std::map<double, double> gross_contrast_deviations(const Plan& plan);

/// Returns the relative deviation of the effective contrast at this point from the set contrast attenuated by the
/// stated air; empty without a camera contrast in kelvin.
[[nodiscard]] std::optional<double> contrast_deviation(const Plan& plan, const TodPoint& point,
                                                       std::span<const Presentation> presentations);

/// Returns JudgementInput::air_transmittance of a camera's run; empty if its contrasts are grey levels or no contrast
/// was presented.
[[nodiscard]] std::optional<double> contrast_transmittance(const Plan& plan,
                                                           std::span<const Presentation> presentations);

/// Observations of the run for the points of its curve.
struct RunFacts {
  std::span<const Presentation> presentations{};
  std::span<const ContrastMeasurement> contrasts{};
  RunConstancy constancy{};
  std::span<const AdequacyFinding> others{};  ///< findings about the whole run
};

/// Returns a sentence that names the changes of the camera that the run could not detect, because it has fewer than two
/// comparable set-ups. Empty if the signal transfer was compared between set-ups, and for contrasts in grey levels.
[[nodiscard]] std::string unchecked_changes(std::span<const ContrastMeasurement> contrasts,
                                            const RunConstancy& constancy);

/// Adds the findings to the adequacy of the points. A finding makes its point unfit for a decision, except for a
/// deviation of the contrast that is within the allowed limit but large enough to report. Changes of the camera apply
/// to all points. Returns the sentence of each finding once.
std::vector<std::string> add_run_findings(TodCurve& curve, const Plan& plan, const RunFacts& run);

}  // namespace todbench
