// What the measure of effective contrast makes of a known contrast before a sensor that is a program.
#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "acquisition/core/result.h"
#include "sim_devices/sensor/module_sensor.h"
#include "tod/registration/registration.h"

namespace todbench {

struct ModuleResponseOptions {
  double delta_t_k = 0;  ///< at which it is asked
  double distance_m = 0;
  double min_reference_px = 0;
  RegistrationOptions registration{};
  LevelEstimate level = LevelEstimate::median;
};

/// As contrast_response(), from pictures of a process of its own less its answers to an empty scene in the same frames
/// (noise that is a function of the frame cancels in them), over the contrast. Errors: those of ModuleSensor,
/// register_plate() and effective_contrast(); `interrupted`. Precondition: sensor_module(spec).
[[nodiscard]] Result<double> module_response(const SensorSpec& spec, std::uint64_t seed, const TargetPlate& plate,
                                             const ModuleResponseOptions& options, std::stop_token stop = {});

/// Moduli of the whole of image formation along x at frequencies in cycles per pitch: the transform of what an edge of
/// 1 K adds to an empty scene, less what it adds one scene sample further, at four places of the edge within a pitch;
/// all rows averaged. Errors: those of ModuleSensor.
[[nodiscard]] Result<std::vector<double>> module_transfer(ModuleSensor& sensor, const SensorSpec& spec,
                                                          const std::vector<double>& cycles_per_pitch);

}  // namespace todbench
