// SPDX-License-Identifier: GPL-3.0-or-later
// Results of the simulated twin that are added to the results of a camera: curve, comparison and physical measures.
#pragma once

#include <stop_token>

#include "bench/run/experiment.h"
#include "bench/run/physical_measures.h"
#include "bench/run/simulated_run.h"
#include "bench/twin/background_task.h"
#include "bench/twin/paired_comparison.h"

namespace todbench {

/// Work that runs in parallel to the measurement with the camera.
struct BackgroundWork {
  BackgroundTask<Pairs>* pairs;  ///< null: no pairs are computed
  BackgroundMeasures& measures;
};

/// Simulates the twin at the contrasts that the camera observed, and adds its run, the comparison and its physical
/// measures. An error ends the session early (`outcome.ended_by`).
void add_twin(ExperimentOutcome& outcome, Provenance& provenance, const FromCamera& camera, const LoadedPlan& loaded,
              const Plan& plan, const ExperimentInputs& inputs, const BackgroundWork& background,
              const ExperimentHost& host, const OpenSession& open, const std::stop_token& stop);

}  // namespace todbench
