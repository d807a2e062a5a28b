// SPDX-License-Identifier: GPL-3.0-or-later
// Plan with its simulated sensor, ready to be measured.
#pragma once

#include <map>
#include <memory>
#include <stop_token>
#include <string>

#include "bench/devices/devices.h"
#include "bench/twin/experiment_inputs.h"
#include "tod/measurement/measurement.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Inputs of measure() except the observer, with the random streams of the plan's seed.
struct SimulatedSetUp {
  MeasurementOptions options;
  OpenedBench bench;
  std::unique_ptr<TrialSchedule> schedule;
  std::map<double, ProportionTable> functions{};  ///< functions for the stopping rule of an adaptive schedule
                                                  ///< (stopping_tables())
};

/// Creates the set-up. `shown_delta_t_k` and `source`: as for simulated_bench(). `responses`: result of
/// simulated_responses() for the same sensor in kelvin. If empty, the responses are computed, which takes half a second
/// per plate. Errors: those of contrast_response().
[[nodiscard]] Result<SimulatedSetUp> simulated_set_up(const Plan& plan, const ExperimentInputs& inputs,
                                                      std::map<double, double> shown_delta_t_k, std::stop_token stop,
                                                      const SimulatedSourceOptions& source = {},
                                                      std::map<std::string, double> responses = {});

}  // namespace todbench
