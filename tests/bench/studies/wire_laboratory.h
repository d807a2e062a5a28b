// SPDX-License-Identifier: GPL-3.0-or-later
// Virtual laboratories over the network: the same errors, in an emulated laboratory with a camera on GigE Vision and
// with black body and plate stage on SCPI. For builds with Aravis.
#pragma once

#include <cstdint>
#include <memory>
#include <stop_token>
#include <vector>

#include "sim_devices/lab/laboratory.h"
#include "tests/bench/studies/virtual_laboratory.h"

namespace todbench {

/// An emulated laboratory on the loopback interface and its opened bench.
struct WireLaboratory {
  std::unique_ptr<Laboratory> laboratory;
  OpenedBench bench;  ///< last: destroyed before the laboratory it is connected to
};

/// Starts a laboratory with the true values of real_set_up(): its black body shows another contrast than it reports,
/// the temperatures of its camera are wrong, and plan and instruments report the set values. One at a time in a network
/// namespace, because the control port of GigE Vision is fixed. `seed`: of the noise of the camera. Errors: those of
/// Laboratory::start() and open_bench().
[[nodiscard]] Result<WireLaboratory> wire_laboratory(const Plan& plan, const ExperimentInputs& inputs,
                                                     const LaboratoryErrors& errors, std::uint64_t seed,
                                                     std::stop_token stop);

/// The same as measured_by_laboratory() over the network: the errors, the schedule and the twin of that laboratory, but
/// its own noise, aim of the camera and frame times in the host's clock. Errors: those of wire_laboratory() and
/// measured_on_bench().
[[nodiscard]] Result<std::vector<LaboratoryPoint>> measured_over_the_wire(const Plan& plan,
                                                                          const ExperimentInputs& inputs,
                                                                          std::uint64_t laboratory,
                                                                          std::stop_token stop);

}  // namespace todbench
