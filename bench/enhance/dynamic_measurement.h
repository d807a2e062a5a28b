// Dynamic TOD measured: a camera before a plate that its stage moves, or the simulated sensor of a plan before its
// scene.
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "bench/enhance/dynamic_acuity.h"
#include "bench/run/devices.h"
#include "tod/measurement/moving_measurement.h"

namespace todbench {

/// Acuities at one contrast, by speed; the first is that of the plate at rest.
struct DynamicContrast {
  double set_delta_t_k = 0;
  double delta_t_k = 0;  ///< as the camera saw it, mean over the passes
  std::vector<DynamicAcuity> speeds;
};

/// From how late pictures show the plate, to the right and to the left: lag = tau + exposure / 2.
struct MeasuredTimeConstant {
  double time_constant_ms = 0;
  Interval ci95_ms;
  double exposure_ms = 0;  ///< stated by the plan's sensor, half of which is taken off the lag
  double offset_px = 0;    ///< by which registration at rest is off, which reversed motion takes out
  int passes = 0;
};
/// Least squares of v lag = v (tau + T / 2) + direction x offset over the passes that moved and whose run has a known
/// beginning, with Student's t. Nothing: fewer than four of them, or of one direction alone.
[[nodiscard]] std::optional<MeasuredTimeConstant> time_constant_of(const std::vector<MovingPassRecord>& passes,
                                                                   double exposure_ms);

struct DynamicMeasurement {
  MovingMeasurement measured;
  std::vector<DynamicContrast> contrasts;
  std::optional<MeasuredTimeConstant> time_constant;
  std::string camera;
  double residual_px = 0;  ///< rms over the passes that moved of the places from the stage's line
};

/// What a measurement says on its way, that of measure_moving() included.
struct DynamicListener {
  MovingListener moving{};
  std::function<Result<void>(const OpenedBench&)> on_open{};  ///< before anything is measured
  /// All passes are there, or as many as there were when the run ended early.
  std::function<Result<void>(const MovingMeasurement&)> on_measured{};
};

/// With the camera of the plan, or without one with its simulated sensor. Errors: those of open_bench() and
/// measure_moving(), early ends included; `invalid_input` for plans with modules or contrasts in grey levels.
[[nodiscard]] Result<DynamicMeasurement> measure_dynamic(const LoadedPlan& loaded, const DynamicListener& listener,
                                                         std::stop_token stop);

}  // namespace todbench
