// What frames and graded answers buy: time on the bench against the interval of S75.
#pragma once

#include <optional>
#include <stop_token>
#include <vector>

#include "bench/run/prediction.h"

namespace todbench {

/// The plan with other answers, all else as it is.
struct PrecisionChoice {
  AnswerKind answers = AnswerKind::binary;
  std::vector<int> frames{1};  ///< per presentation: of every contrast, or one number for each
  std::vector<ContrastPrediction> contrasts{};
  std::optional<double> half_width_percent{};  ///< half the 95 % interval of S75, the largest over the contrasts
  double seconds = 0;        ///< of the measurement with the camera, or of the simulation where the plan has none
  bool planned = false;      ///< what the plan says
  bool recommended = false;  ///< of the graded ones that which buys most: least squared half-width times seconds
};

/// The plan with as many phases of the simulation as the camera is shown, where there is one: predict_plan() of it is
/// about the camera's curve.
[[nodiscard]] Plan as_measured(Plan plan);

/// Of the camera's curve where there is one: binary answers, and graded ones with 1, 2, 4 and 8 frames; the plan's own
/// numbers (with_frames()), where they are others. Half-widths are those of predict_plan(), times those of
/// predict_times() (1 and 2 frames are timed, the others follow). Errors as there.
[[nodiscard]] Result<std::vector<PrecisionChoice>> precision_frontier(const Plan& plan, const ExperimentInputs& inputs,
                                                                      std::stop_token stop);

/// `plan --json` and `cost --json`, key "frontier".
[[nodiscard]] Json frontier_json(const std::vector<PrecisionChoice>& choices);

}  // namespace todbench
