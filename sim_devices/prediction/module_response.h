// SPDX-License-Identifier: GPL-3.0-or-later
// Response of the estimator of effective contrast for a program in place of the sensor.
#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "acquisition/base/result.h"
#include "sim_devices/sensor/module_sensor.h"
#include "tod/registration/registration.h"

namespace todbench {

/// Conditions of the test pictures.
struct ModuleResponseOptions {
  double delta_t_k = 0;                         ///< contrast of the test pictures
  double distance_m = 0;                        ///< distance from camera to plate
  double min_reference_px = 0;                  ///< smallest triangle that measures the contrast
  RegistrationOptions registration{};           ///< options of the registration of the plate
  LevelEstimate level = LevelEstimate::median;  ///< estimate of the level of a triangle
};

/// Returns the response as contrast_response() does, with pictures from a separate process. The output of this process
/// for an empty scene in the same frames is subtracted, and the difference is divided by the contrast. Noise that
/// depends only on the frame number cancels. Errors: those of ModuleSensor, register_plate() and effective_contrast();
/// `interrupted`. Precondition: sensor_module(spec).
[[nodiscard]] Result<double> module_response(const SensorSpec& spec, std::uint64_t seed, const TargetPlate& plate,
                                             const ModuleResponseOptions& options, std::stop_token stop = {});

/// Returns the modulus of the transfer function of the whole image formation along x, at frequencies in cycles per
/// pitch. The modulus is that of the Fourier transform of the line response: the difference between pictures of a 1 K
/// edge at positions one scene sample apart, for four positions within a pitch, averaged over all rows. Errors: those
/// of ModuleSensor.
[[nodiscard]] Result<std::vector<double>> module_transfer(ModuleSensor& sensor, const SensorSpec& spec,
                                                          const std::vector<double>& cycles_per_pitch);

}  // namespace todbench
