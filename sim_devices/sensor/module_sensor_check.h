// SPDX-License-Identifier: GPL-3.0-or-later
// Contract test for authors of sensor programs.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "sim_devices/sensor/module_sensor.h"

namespace todbench {

/// Properties of a sensor program that fulfils the contract. The contract allows any values of these properties.
struct SensorModuleReport {
  std::vector<cv::Size> shapes;    ///< sizes of the frames that the program returned, in pixels
  bool network_cut = false;        ///< the program could not reach any other computer
  double latency_ms = 0;           ///< median time of twenty frames of 320 x 240 pixels
  double response = 0;             ///< mean output for a 1 K scene minus mean for an empty scene, in the same frame
  double noise_k = 0;              ///< rms difference of two frames of an empty scene, over sqrt(2)
  bool linear = false;             ///< linearity_deviation below 1e-4
  double linearity_deviation = 0;  ///< as in ModuleReport, within one frame
};

/// Starts the program of `spec` several times, with frames of several sizes. Errors: those of ModuleSensor, and
/// `integrity` if two processes return different frames for the same scenes.
[[nodiscard]] Result<SensorModuleReport> check_sensor(const SensorSpec& spec);

}  // namespace todbench
