// SPDX-License-Identifier: GPL-3.0-or-later
// The trials of a simulated sensor, alone or as the twin of a camera, with their curve.
#pragma once

#include <map>
#include <stop_token>
#include <string>

#include "bench/devices/experiment_host.h"
#include "bench/run/session_end.h"
#include "bench/twin/experiment_inputs.h"
#include "tod/measurement/measurement.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// The trial design of a plan on the simulated sensor.
struct SimulatedRun {
  MeasurementResult result;
  TodCurve curve;
  double wall_s = 0;
};

/// Inputs of a twin from its camera; empty for a simulation alone.
struct FromCamera {
  const TodCurve* curve = nullptr;
  const TodCurve* functions = nullptr;         ///< fitted with the functions of the twin
  std::map<double, double> shown_delta_t_k{};  ///< observed contrast for each set contrast
  std::map<std::string, double> responses{};   ///< results of simulated_responses(), if they also apply to the twin
};

/// Simulates the trials into the session, fits them, and adds the direct estimate. Errors: those of record_trials(),
/// and of tod_curve() if there are too few trials for a curve.
[[nodiscard]] Result<SimulatedRun> run_simulated(const Plan& plan, const ExperimentInputs& inputs,
                                                 const OpenSession& open, SessionCurve which, const FromCamera& camera,
                                                 const ExperimentHost& host, std::stop_token stop);

}  // namespace todbench
