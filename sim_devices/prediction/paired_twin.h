// The simulated sensor before the very presentations that a camera answered: the other half of a paired comparison.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/core/accuracy.h"
#include "hvs/observer/observer.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"
#include "tod/plate/target_plate.h"
#include "tod/presentation/trial.h"

namespace todbench {

/// By plate and mounting, clockwise in the picture, as registration found it; a missing one is 0.
using PlateRotations = std::map<std::pair<std::string, Mounting>, double>;

struct PairedTwinOptions {
  static constexpr int default_draws = 24;
  int draws = default_draws;  ///< pictures of each presentation, 2 or more, each with noise of its own
  int graded_draws = 32;      ///< of the observer's own noise for each picture
  PlateRotations rotations_deg{};
  SceneMotion motion{};
  Accuracy accuracy{};
  /// May be that of the camera's own simulation: temporal noise, fixed pattern and the observer's noise are of streams
  /// that nothing else draws from.
  std::uint64_t seed = 1;
  std::stop_token stop{};
};

/// What the twin answers to the presentation of a trial.
struct TwinAnswer {
  double probability_correct = 0;  ///< mean over the pictures
  double variance = 0;             ///< of that mean, from the scatter over the pictures
};

/// Every trial shown to the simulated sensor as the camera had it: sub-pixel phase of its triangle, rotation of its
/// plate, contrast that the camera saw (which is also what the observer divides by); size in mrad, with the
/// sensor's own instantaneous field of view. One answer per trial, in their order; trials of a presentation follow each
/// other.
///
/// Only the windows round the triangles are computed, edge by edge in one picture; triangles elsewhere on the plate add
/// nothing to a window. Fixed pattern and dead pixels are new in every draw and set-up: the mean is over them as well.
/// `interrupted` within a presentation; `invalid_input` for fewer than two draws, a contrast or size that is none, and
/// as Observer::prepare().
[[nodiscard]] Result<std::vector<TwinAnswer>> twin_answers(const SensorSpec& sensor, const SensorPlan& effects,
                                                           Observer& observer, std::span<const Trial> trials,
                                                           const PairedTwinOptions& options);

}  // namespace todbench
