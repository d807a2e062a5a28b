// Virtual laboratories over the wire: the same errors, in an emulated laboratory whose camera is on GigE Vision and
// whose black body and plate stage are on SCPI. Of builds with Aravis.
#pragma once

#include <cstdint>
#include <memory>
#include <stop_token>
#include <vector>

#include "bench/studies/virtual_laboratory.h"
#include "sim_devices/lab/laboratory.h"

namespace todbench {

/// An emulated laboratory on the loopback interface, and what was opened in it.
struct WireLaboratory {
  std::unique_ptr<Laboratory> laboratory;
  OpenedBench bench;  ///< last, so that it is gone before what it is connected to
};

/// The laboratory really is what real_set_up() says: its black body shows another contrast than it says, its camera
/// states kelvin that are wrong, and plan and instruments say what was told. One at a time in a network namespace: the
/// control port of GigE Vision is fixed. `seed` is that of the noise of the camera. Errors: of Laboratory::start() and
/// open_bench().
[[nodiscard]] Result<WireLaboratory> wire_laboratory(const Plan& plan, const ExperimentInputs& inputs,
                                                     const LaboratoryErrors& errors, std::uint64_t seed,
                                                     std::stop_token stop);

/// measured_by_laboratory() over the wire: the errors, the schedule and the twin of that laboratory, with noise, an aim
/// of the camera and frames in the time of the host that are its own. Errors: of wire_laboratory() and
/// measured_on_bench().
[[nodiscard]] Result<std::vector<LaboratoryPoint>> measured_over_the_wire(const Plan& plan,
                                                                          const ExperimentInputs& inputs,
                                                                          std::uint64_t laboratory,
                                                                          std::stop_token stop);

}  // namespace todbench
