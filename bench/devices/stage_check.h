// SPDX-License-Identifier: GPL-3.0-or-later
// Check of the movements of a stage (signs, axes, scale) with the pictures of the camera.
#pragma once

#include <stop_token>
#include <string>

#include "bench/devices/devices.h"
#include "bench/plan/loaded_plan.h"
#include "tod/measurement/stage_fit.h"

namespace todbench {

/// Result of the check.
struct StageMovement {
  double driven_px = 0;  ///< requested movement to either side of the centre, along each axis
  StageFit fit;          ///< fit of the observed positions to the requested positions
  std::string cause{};   ///< reason of a deviation, as a clause; empty: the stage moves correctly
};

/// Largest accepted deviation of StageFit::seen_per_asked from the unit matrix, per element. The check adds four
/// standard errors. Shifts of a run reach 0.7 px: an error of 0.1 reduces the acuity by less than 0.2 %.
inline constexpr double most_stage_deviation = 0.1;

/// Opens camera and target of the plan and presents the first plate at the highest contrast in the centre. Then moves
/// the stage by one pixel to either side of the centre, first along x and then along y. Errors: `invalid_input` (no
/// stage that sets positions), `calibration` (the pictures do not show the plate), those of open_bench() and measure().
[[nodiscard]] Result<StageMovement> check_stage_movement(const LoadedPlan& loaded, const SayProgress& on_progress,
                                                         std::stop_token stop);

}  // namespace todbench
