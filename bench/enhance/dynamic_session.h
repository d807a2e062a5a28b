// Dynamic TOD of a plan as a session: the folder of a measurement, whose curve is that of the plate at rest.
#pragma once

#include <functional>
#include <stop_token>

#include "bench/enhance/dynamic_measurement.h"
#include "bench/run/experiment.h"

namespace todbench {

struct DynamicSession {
  DynamicMeasurement found;
  ExperimentOutcome outcome;  ///< of the plate at rest, its first frames judged: what the limits of the plan are about
};

/// What a plan asks for and a target that moves does not have, in one sentence; `invalid_input`.
[[nodiscard]] Result<void> check_dynamic_plan(const Plan& plan, const SensorSpec& sensor);

/// measure_dynamic() into a session folder: trials.csv, fits, verdict and report are those of the plate at rest,
/// `single-frame`; dynamic.json has everything, moving-trials.csv the answers of all speeds and observers. Errors:
/// those of measure_dynamic() and check_dynamic_plan(), without a folder until the devices are open, with one marked
/// interrupted and the trials so far after that.
[[nodiscard]] Result<DynamicSession> measure_dynamic_session(
    const LoadedPlan& loaded, const ExperimentOptions& options, const ExperimentListener& listener,
    const std::function<void(const MovingPassRecord&)>& on_pass, std::stop_token stop);

}  // namespace todbench
