// SPDX-License-Identifier: GPL-3.0-or-later
// Measures of an emulated laboratory, without trials.
#pragma once

#include "bench/devices/devices.h"
#include "bench/devices/emulation.h"
#include "bench/plan/plan_options.h"
#include "tod/camera_measures/camera_measures.h"

namespace todbench::testing {

/// What a laboratory's camera is measured to be; nothing of the trials.
inline Result<CameraMeasures> measured(const Plan& plan, const EmulationArguments& arguments,
                                       CameraMeasuresOptions options) {
  auto laboratory = start_laboratory(arguments);
  if (!laboratory) return tl::unexpected(laboratory.error());
  const auto loaded = LoadedPlan::load(with_laboratory(plan, **laboratory));
  if (!loaded) return tl::unexpected(loaded.error());
  auto bench = open_bench(*loaded, {});
  if (!bench) return tl::unexpected(bench.error());
  options.transfer_steps_k = {16.9};
  options.measurement = measurement_options(loaded->plan(), loaded->plates(), plan.camera.ifov_mrad);
  return measure_camera(*bench->camera, *bench->target, options, *bench->host, {});
}

}  // namespace todbench::testing
