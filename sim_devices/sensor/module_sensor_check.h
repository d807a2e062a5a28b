// The contract test for authors of sensors that are programs.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "sim_devices/sensor/module_sensor.h"

namespace todbench {

/// What a program that keeps the contract of a sensor was found to do. Nothing of it is a fault.
struct SensorModuleReport {
  std::vector<cv::Size> shapes;    ///< frames that it answered with, in pixels
  bool network_cut = false;        ///< it could reach nobody
  double latency_ms = 0;           ///< median of twenty frames of 320 x 240 pixels
  double response = 0;             ///< mean answer to a scene of 1 K, less that to an empty one in the same frame
  double noise_k = 0;              ///< rms of the difference of two frames of an empty scene over sqrt(2)
  bool linear = false;             ///< deviation below 1e-4
  double linearity_deviation = 0;  ///< as of ModuleReport, in one and the same frame
};

/// Starts the program several times as the sensor that `module` and the numbers of `spec` say, with frames of several
/// sizes. Errors: those of ModuleSensor, and `integrity` when two processes answer the same scenes and frames
/// differently.
[[nodiscard]] Result<SensorModuleReport> check_sensor(const SensorSpec& spec);

}  // namespace todbench
