// SPDX-License-Identifier: GPL-3.0-or-later
// A measurement through an emulated camera, and that of the simulated camera over the exposures that came through it.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <vector>

#include "acquisition/core/camera_registry.h"
#include "sim_devices/lab/laboratory_camera.h"
#include "tests/tod/measurement/free_running_camera.h"
#include "tests/tod/measurement/measurement_bench.h"

namespace todbench::test {

/// Frames per second of the cameras that are measured twice.
inline constexpr double twice_frame_rate_hz = 100;

/// What is measured: two contrasts, one mounting, three phases.
inline SimulatedBench bench_for_both() {
  SimulatedBench bench;
  bench.spec.frame_rate_hz = twice_frame_rate_hz;
  bench.contrasts = {1.93, 0.23};
  bench.mountings = {Mounting::identity};
  bench.phases = 3;
  return bench;
}

inline MeasurementOptions options_for_both(const SimulatedBench& bench) {
  MeasurementOptions options = options_of(bench);
  options.registration_frames = 8;
  options.contrast_frames = 8;
  options.frame_timeout = std::chrono::seconds(20);
  return options;
}

struct EmulatedCase {
  ConnectCamera connect;
  std::unique_ptr<CameraBackend> backend;
  ExposureOf exposure_of;
  std::function<bool(std::uint64_t)> is_short = {};  ///< exposures that arrive short; empty: none
};

struct MeasuredTwice {
  MeasurementResult measured, simulated;
  std::vector<std::uint64_t> exposures;  ///< that came through
};

/// Fails the test fatally where one of the two measurements does not end well.
inline void measure_twice(const SimulatedBench& bench, const MeasurementOptions& options, EmulatedCase under_test,
                          MeasuredTwice& both) {
  TemplateObserver observer({}, triangle_alternatives());
  const SensorModel model(bench.spec, full_plan(bench.spec, {}, {}), Accuracy::normal(), 1);
  PlateScene empty;
  empty.distance_m = bench.distance_m;
  SceneHolder before_camera(empty);
  ExposureLog log;
  const auto camera = under_test.connect(bench.spec, [&](std::uint64_t index) {
    auto scene = before_camera.scene();
    log.add(index, scene);
    return model.expose(*scene, index);
  });
  ASSERT_TRUE(camera) << camera.error().message;
  const auto source = under_test.backend->open((*camera)->id());
  ASSERT_TRUE(source) << source.error().message;
  for (const auto& [name, value] : (*camera)->settings()) ASSERT_TRUE((*source)->set(name, value));
  const auto share = [](SceneHolder& holder) { return std::shared_ptr<SceneHolder>(&holder, [](SceneHolder*) {}); };

  PresentScene fresh(**source, before_camera, log, under_test.exposure_of);
  auto schedule = schedule_of(bench);
  const auto measured = measure(fresh, *scene_target(share(before_camera), bench.plates), observer, schedule, options,
                                *bench.host, {}, {});
  ASSERT_TRUE(measured) << measured.error().message;
  ASSERT_FALSE(measured->ended_by) << measured->ended_by->message;

  SceneHolder before_simulation(empty);
  GivenExposures given(fresh.info(), model, before_simulation, fresh.exposures(), under_test.is_short);
  auto same_schedule = schedule_of(bench);
  const auto simulated = measure(given, *scene_target(share(before_simulation), bench.plates), observer, same_schedule,
                                 options, *bench.host, {}, {});
  ASSERT_TRUE(simulated) << simulated.error().message;
  both = {.measured = *measured, .simulated = *simulated, .exposures = fresh.exposures()};
}

}  // namespace todbench::test
