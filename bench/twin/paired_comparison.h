// SPDX-License-Identifier: GPL-3.0-or-later
// Comparison of a camera with its twin by the phases that camera and twin both observed.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "bench/twin/background_task.h"
#include "bench/twin/experiment_inputs.h"
#include "sim_devices/prediction/paired_twin.h"
#include "tod/comparison/comparison.h"
#include "tod/measurement/measurement.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Returns whether a plan requests paired comparison and its answers allow it.
[[nodiscard]] bool pairs_asked(const Plan& plan, const SensorSpec& sensor);

/// Answers of a camera.
struct PairedCamera {
  const TodCurve& curve;  ///< fitted with the functions of the twin
  std::span<const Trial> trials;
  std::span<const SetUpRecord> set_ups;  ///< positions of the plates
  /// Fit with the functions of the twin, if `curve` is fitted with the functions of the camera's surrogate. Null:
  /// `curve` is fitted with the functions of the twin.
  const TodCurve* by_twin = nullptr;
  /// By set contrast: standard uncertainty of ln S75 of a camera whose pictures do not confirm its model; null: none.
  const std::map<double, double>* model_u = nullptr;
  /// Trials as they were fitted, at the set contrasts, if these differ from the shown contrasts. Empty: `trials`.
  std::span<const Trial> fitted{};
};

/// Notes and error of a paired comparison.
struct PairedOutcome {
  std::vector<std::string> notes;  ///< one sentence for each contrast without a paired ratio
  std::optional<Error> ended_by;   ///< `interrupted`
};

/// Returns the options for showing the camera's presentations to the twin.
[[nodiscard]] PairedTwinOptions paired_options(const ExperimentInputs& inputs, std::span<const SetUpRecord> set_ups,
                                               std::uint64_t seed, std::stop_token stop);

/// Shows the twin every presentation of the camera (twin_answers()) and adds the paired ratios (paired_ratio()) to the
/// points of a comparison in which curve A is the camera's curve. A point keeps the unpaired ratio if it has no
/// function of the twin, no graded answers, or no point in the camera's curve. If a threshold is not fit for a
/// decision, the paired verdict is inconclusive too.
[[nodiscard]] PairedOutcome add_paired_ratios(Comparison& comparison, const PairedCamera& camera,
                                              const ExperimentInputs& inputs, const PairedTwinOptions& options);

/// Paired ratios of all contrasts of a curve.
struct Pairs {
  Comparison ratios;  ///< only contrast, margin and paired ratios of its points are set
  PairedOutcome said;
};
/// Computes the pairs on its own thread while the physical measures of the camera and the trials of the twin are made.
/// Null if the plan requests no pairs. `camera_of` is called on that thread and may wait for its curve. The plan, the
/// inputs and the objects that `camera_of` refers to must outlive the task.
[[nodiscard]] std::unique_ptr<BackgroundTask<Pairs>> pairs_in_background(
    std::function<PairedCamera(std::stop_token)> camera_of, const Plan& plan, const ExperimentInputs& inputs);

}  // namespace todbench
