// SPDX-License-Identifier: GPL-3.0-or-later
// Host of a measurement on an opened bench.
#pragma once

#include <memory>

#include "bench/devices/pause.h"
#include "bench/devices/reconnecting_source.h"
#include "tod/measurement/run_controller.h"

namespace todbench {

/// Options of bench_host(). The objects to which the pointers refer must outlive the host.
struct BenchHostOptions {
  const Pause* pause = nullptr;  ///< null: the run never pauses
  FramesWhilePresenting frames_while_presenting = FramesWhilePresenting::leave;
  ReconnectingSource* camera = nullptr;  ///< a camera that may reconnect; null: a loss ends the run
};

/// Creates the host. Its clock is CLOCK_MONOTONIC.
[[nodiscard]] std::unique_ptr<RunController> bench_host(const BenchHostOptions& options);

}  // namespace todbench
