// SPDX-License-Identifier: GPL-3.0-or-later
// Bench time against the interval of S75, for numbers of frames and kinds of answers.
#pragma once

#include <optional>
#include <stop_token>
#include <vector>

#include "bench/forecast/prediction.h"

namespace todbench {

/// Variant of the plan with other answers.
struct PrecisionChoice {
  AnswerKind answers = AnswerKind::binary;
  std::vector<int> frames{1};  ///< frames per presentation: one number for all contrasts, or one for each
  std::vector<ContrastPrediction> contrasts{};
  std::optional<double> half_width_percent{};  ///< half of the 95 % interval of S75, the largest over the contrasts
  double bench_s = 0;                          ///< time on the bench only; 0 without a camera
  double seconds = 0;    ///< time of the measurement with the camera, or of the simulation if the plan has no camera
  bool planned = false;  ///< true for the plan itself
  /// True for the graded choice with the smallest squared half-width times bench time (without a camera, simulation
  /// time). The recommendation does not depend on the load of the computer, because bench time does not. The half-width
  /// contains the rows of the budget, which frames do not reduce; with these rows, the recommended choice is the
  /// fastest within 5 % of the smallest product.
  bool recommended = false;
};

/// Returns the choices for the camera's curve, if there is one: binary answers, graded answers with 1, 2, 4 and 8
/// frames, and the plan's own numbers (with_frames()) if they differ. Half-widths come from predict_plan(). The time of
/// the plan's own choice is computed by predict_times(), or read from `figures` if `figures` contains it. For graded
/// answers a second number of frames is timed too, and the times of the other numbers are computed from both. For a
/// ramp, returns only the plan's own choice, because other numbers of frames would change its rate. Errors: those of
/// predict_plan() and predict_times().
[[nodiscard]] Result<std::vector<PrecisionChoice>> precision_frontier(const Plan& plan, const ExperimentInputs& inputs,
                                                                      std::stop_token stop, PlanFigures figures = {});

/// Returns the value of the key "frontier" of `plan --json` and `cost --json`.
[[nodiscard]] Json frontier_json(const std::vector<PrecisionChoice>& choices);

}  // namespace todbench
