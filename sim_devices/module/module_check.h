// The contract test for authors of modules.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "sim_devices/module/module_process.h"

namespace todbench {

/// What a module that keeps the contract was found to do. Nothing of it is a fault.
struct ModuleReport {
  std::vector<cv::Size> shapes;  ///< that it answered
  bool network_cut = false;      ///< it could reach nobody
  double latency_ms = 0;         ///< median of an exchange of 320 x 240 numbers
  bool linear = false;           ///< deviation below 1e-4
  double linearity_deviation =
      0;                       ///< of f(2 a - b / 2) from 2 f(a) - f(b) / 2 less f(0)'s part, over the largest answer
  cv::Mat1f impulse_response;  ///< to a 1 in the middle of zeros, less the answer to zeros: 9 x 9 round it
  double impulse_sum = 0;      ///< of the whole response
};

/// Starts the module three times and asks it for pictures of several shapes. Errors: those of ModuleProcess, and
/// `integrity` when two processes answer the same pictures differently.
[[nodiscard]] Result<ModuleReport> check_module(const ModuleOptions& options);

}  // namespace todbench
