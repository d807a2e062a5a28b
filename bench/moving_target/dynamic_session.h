// SPDX-License-Identifier: GPL-3.0-or-later
// Session of a dynamic TOD measurement: a session folder with the curve of the plate at rest and the results at all
// speeds.
#pragma once

#include <functional>
#include <stop_token>

#include "bench/moving_target/dynamic_measurement.h"
#include "bench/run/experiment.h"

namespace todbench {

/// Result of a measurement, and the outcome of its session.
struct DynamicSession {
  DynamicMeasurement found;
  /// Outcome for the plate at rest, from the first frames of its passes. The limits of the plan apply to this outcome.
  ExperimentOutcome outcome;
};

/// Fails with `invalid_input` if the plan requests something that does not apply to a moving target.
[[nodiscard]] Result<void> check_dynamic_plan(const Plan& plan, const SensorSpec& sensor);

/// Runs measure_dynamic() and writes its session folder. trials.csv, fits, verdict and report are for the plate at rest
/// and the observer `single-frame`. dynamic.json contains all results. moving-trials.csv contains the answers of all
/// observers at all speeds. Errors: those of measure_dynamic() and check_dynamic_plan(). After an error before the
/// devices are open there is no folder. After a later error the folder is marked interrupted and contains the earlier
/// trials.
[[nodiscard]] Result<DynamicSession> measure_dynamic_session(
    const LoadedPlan& loaded, const ExperimentOptions& options, const ExperimentListener& listener,
    const std::function<void(const MovingPassRecord&)>& on_pass, std::stop_token stop);

}  // namespace todbench
