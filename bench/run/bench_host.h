// The host of a measurement on an opened bench.
#pragma once

#include <memory>

#include "bench/run/pause.h"
#include "bench/run/reconnecting_source.h"
#include "tod/measurement/measurement_host.h"

namespace todbench {

/// What there is to command with. Everything outlives the host.
struct BenchHostOptions {
  const Pause* pause = nullptr;  ///< null: the run never rests
  FramesMeanwhile frames_while_presenting = FramesMeanwhile::leave;
  ReconnectingSource* camera = nullptr;  ///< the camera, where it may come back; null: a loss ends the run
};

/// The clock is CLOCK_MONOTONIC.
[[nodiscard]] std::unique_ptr<MeasurementHost> bench_host(const BenchHostOptions& options);

}  // namespace todbench
