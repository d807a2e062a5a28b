// SPDX-License-Identifier: GPL-3.0-or-later
// Contract test for authors of modules.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "sim_devices/module/module_process.h"

namespace todbench {

/// Properties of a module that fulfils the contract. The contract allows any values of these properties.
struct ModuleReport {
  std::vector<cv::Size> shapes;  ///< sizes of the pictures that the module processed
  bool network_cut = false;      ///< the module could not reach any other computer
  double latency_ms = 0;         ///< median time of twenty exchanges of 320 x 240 numbers
  bool linear = false;           ///< linearity_deviation below 1e-4
  /// Largest |g(2 a - b / 2) - (2 g(a) - g(b) / 2)| with g = f - f(0), relative to the largest output of the module f.
  double linearity_deviation = 0;
  cv::Mat1f impulse_response;  ///< output for a 1 in the middle of zeros minus output for zeros: the central 9 x 9
  double impulse_sum = 0;      ///< sum of the whole response
};

/// Starts the module three times and sends it pictures of several shapes. Errors: those of ModuleProcess, and
/// `integrity` if two processes return different outputs for the same pictures.
[[nodiscard]] Result<ModuleReport> check_module(const ModuleOptions& options);

}  // namespace todbench
