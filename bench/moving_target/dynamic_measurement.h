// SPDX-License-Identifier: GPL-3.0-or-later
// Measurement of the dynamic TOD: a camera in front of a plate that a stage moves, or the simulated sensor of a plan in
// front of a simulated scene.
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "bench/devices/devices.h"
#include "bench/moving_target/dynamic_acuity.h"
#include "tod/measurement/moving_measurement.h"

namespace todbench {

/// Acuities at one contrast, by speed; the first entry is the plate at rest.
struct DynamicContrast {
  double set_delta_t_k = 0;
  double delta_t_k = 0;  ///< observed by the camera, mean over the passes
  std::vector<DynamicAcuity> speeds;
};

/// Time constant tau from the lag (in time) of the plate in the pictures, in both directions: lag = tau + exposure / 2.
struct MeasuredTimeConstant {
  double time_constant_ms = 0;
  Interval ci95_ms;
  double exposure_ms = 0;  ///< exposure of the sensor of the plan; half of the exposure is subtracted from the lag
  double offset_px = 0;    ///< error of the registration at rest, which passes in both directions eliminate
  int passes = 0;
};
/// Fits v lag = v (tau + T / 2) + direction x offset (v: speed, T: exposure) by least squares over the moving passes
/// with a known start of the motion. The interval uses Student's t. Empty: fewer than four passes, or one direction.
[[nodiscard]] std::optional<MeasuredTimeConstant> time_constant_of(const std::vector<MovingPassRecord>& passes,
                                                                   double exposure_ms);

/// Result of a measurement.
struct DynamicMeasurement {
  MovingMeasurement measured;
  std::vector<DynamicContrast> contrasts;
  std::optional<MeasuredTimeConstant> time_constant;
  std::string camera;
  double residual_px = 0;  ///< rms deviation of the positions in moving passes from the motion of the stage
};

/// Callbacks of a measurement, including the callbacks of measure_moving().
struct DynamicListener {
  MovingListener moving{};
  std::function<Result<void>(const OpenedBench&)> on_open{};  ///< called before the first measurement
  /// Receives all passes; after an early end, the passes made before the end.
  std::function<Result<void>(const MovingMeasurement&)> on_measured{};
};

/// Measures with the camera of the plan, or with its simulated sensor if the plan has no camera. Errors: those of
/// open_bench() and measure_moving(), including early ends; `invalid_input` for plans with modules or contrasts in grey
/// levels.
[[nodiscard]] Result<DynamicMeasurement> measure_dynamic(const LoadedPlan& loaded, const DynamicListener& listener,
                                                         std::stop_token stop);

}  // namespace todbench
