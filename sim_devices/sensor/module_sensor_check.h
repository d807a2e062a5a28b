// SPDX-License-Identifier: GPL-3.0-or-later
// Contract test for authors of sensor programs.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "sim_devices/sensor/module_sensor.h"

namespace todbench {

/// Properties of a sensor program that keeps the contract. None of them is a fault.
struct SensorModuleReport {
  std::vector<cv::Size> shapes;    ///< sizes of the frames that it answered, in pixels
  bool network_cut = false;        ///< it could not reach any other computer
  double latency_ms = 0;           ///< median of twenty frames of 320 x 240 pixels
  double response = 0;             ///< mean answer to a scene of 1 K, less that to an empty scene in the same frame
  double noise_k = 0;              ///< rms difference of two frames of an empty scene, over sqrt(2)
  bool linear = false;             ///< linearity_deviation below 1e-4
  double linearity_deviation = 0;  ///< as in ModuleReport, within one frame
};

/// Starts the program of `spec` several times, with frames of several sizes. Errors: those of ModuleSensor, and
/// `integrity` if two processes answer the same scenes and frames differently.
[[nodiscard]] Result<SensorModuleReport> check_sensor(const SensorSpec& spec);

}  // namespace todbench
