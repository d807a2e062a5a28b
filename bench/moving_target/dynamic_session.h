// SPDX-License-Identifier: GPL-3.0-or-later
// Dynamic TOD of a plan as a session: the folder of a measurement, with the curve of the plate at rest.
#pragma once

#include <functional>
#include <stop_token>

#include "bench/moving_target/dynamic_measurement.h"
#include "bench/run/experiment.h"

namespace todbench {

/// Result with its session.
struct DynamicSession {
  DynamicMeasurement found;
  /// Outcome for the plate at rest, from its first frames; the limits of the plan apply to it.
  ExperimentOutcome outcome;
};

/// Fails with `invalid_input` and one sentence if the plan requests something that does not apply to a moving target.
[[nodiscard]] Result<void> check_dynamic_plan(const Plan& plan, const SensorSpec& sensor);

/// Runs measure_dynamic() and writes its session folder. trials.csv, fits, verdict and report are for the plate at rest
/// and the observer `single-frame`. dynamic.json contains all results. moving-trials.csv contains the answers at all
/// speeds, of all observers.
/// Errors: those of measure_dynamic() and check_dynamic_plan(). An error before the devices are open leaves no folder;
/// a later one leaves a folder that is marked interrupted and contains the trials so far.
[[nodiscard]] Result<DynamicSession> measure_dynamic_session(
    const LoadedPlan& loaded, const ExperimentOptions& options, const ExperimentListener& listener,
    const std::function<void(const MovingPassRecord&)>& on_pass, std::stop_token stop);

}  // namespace todbench
