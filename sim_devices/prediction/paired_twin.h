// SPDX-License-Identifier: GPL-3.0-or-later
// Answers of the twin to the presentations that a camera showed: the second half of a paired comparison.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/base/accuracy.h"
#include "hvs/observer/observer.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"
#include "tod/plate/target_plate.h"
#include "tod/presentation/trial.h"

namespace todbench {

/// Rotations of the plates in degrees, by plate and mounting, clockwise in the picture; a missing entry is 0.
using PlateRotations = std::map<std::pair<std::string, Mounting>, double>;

/// Options of twin_answers().
struct PairedTwinOptions {
  static constexpr int default_draws = 24;
  int draws = default_draws;       ///< pictures of each presentation with independent noise; at least 2
  int graded_draws = 32;           ///< draws of the observer's internal noise for each picture
  PlateRotations rotations_deg{};  ///< rotations of the plates in the pictures of the camera
  SceneMotion motion{};            ///< motion of the target
  Accuracy accuracy{};
  /// Seed of noise and answers. It may equal the seed of the camera's own simulation, because temporal noise, fixed
  /// pattern and observer's noise use separate streams.
  std::uint64_t seed = 1;
  std::stop_token stop{};
};

/// Answer of the twin to the presentation of a trial.
struct TwinAnswer {
  double probability_correct = 0;  ///< mean over the pictures
  double variance = 0;             ///< variance of that mean, from the scatter over the pictures
};

/// Shows every trial to the simulated sensor as the camera observed the trial: with the sub-pixel phase of the
/// triangle, the rotation of the plate and the effective contrast, by which the observer also divides. The size in mrad
/// is converted with the instantaneous field of view of the sensor. Returns one answer per trial, in the same order.
/// Trials of a presentation must be consecutive.
///
/// Computes only the windows round the triangles, edge by edge in one picture. Other triangles of the plate do not
/// contribute to a window. Fixed pattern and dead pixels are new in every draw and set-up, so the mean includes them.
/// Errors: `interrupted` within a presentation, `invalid_input` (fewer than two draws, an invalid contrast or size),
/// and those of Observer::prepare().
[[nodiscard]] Result<std::vector<TwinAnswer>> twin_answers(const SensorSpec& sensor, const SensorPlan& effects,
                                                           Observer& observer, std::span<const Trial> trials,
                                                           const PairedTwinOptions& options);

}  // namespace todbench
