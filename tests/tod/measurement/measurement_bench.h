// SPDX-License-Identifier: GPL-3.0-or-later
// The measurement on a simulated camera, as tests set it up.
#pragma once

#include <memory>
#include <vector>

#include "hvs/observer/template_observer.h"
#include "sim_devices/sensor/simulated_camera.h"
#include "tests/sim_devices/reference.h"
#include "tests/sim_devices/test_plates.h"
#include "tests/tod/measurement/test_host.h"
#include "tod/measurement/measurement.h"

namespace todbench::test {

struct SimulatedBench {
  SensorSpec spec = sc2000();
  std::vector<Effect> skip;
  std::vector<TargetPlate> plates = two_plates();
  std::vector<Mounting> mountings{all_mountings.begin(), all_mountings.end()};
  std::vector<double> contrasts{16.9, 1.93, 0.23};
  double distance_m = 2;
  int phases = 4;
  std::uint64_t seed = 1;
  std::shared_ptr<TestHost> host = std::make_shared<TestHost>();  ///< of its runs
};

inline MeasurementOptions options_of(const SimulatedBench& bench) {
  MeasurementOptions options;
  options.ifov_mrad = bench.spec.ifov_mrad();
  options.distance_m = bench.distance_m;
  options.plates = bench.plates;
  options.frames_after_change = 0;
  options.seed = bench.seed;
  return options;
}

inline ListedSchedule schedule_of(const SimulatedBench& bench) {
  ConstantStimuliOptions stimuli;
  for (const auto& plate : bench.plates) stimuli.plates.push_back(plate.name);
  stimuli.mountings = bench.mountings;
  stimuli.delta_t_k = bench.contrasts;
  stimuli.phases = bench.phases;
  stimuli.pixel_mm = bench.distance_m * bench.spec.ifov_mrad();
  return ListedSchedule(constant_stimuli(stimuli, RandomStream(bench.seed, "schedule")));
}

/// `model`: shared by runs of one seed, so that pictures are formed once; nothing: made here.
inline Result<MeasurementResult> run(const SimulatedBench& bench, Observer& observer, const MeasurementOptions& options,
                                     std::shared_ptr<const SensorModel> model = nullptr,
                                     const MeasurementListener& listener = {}, std::stop_token stop = {}) {
  if (model == nullptr) {
    model = std::make_shared<const SensorModel>(bench.spec, full_plan(bench.spec, bench.skip, {}), Accuracy::normal(),
                                                bench.seed);
  }
  PlateScene scene;
  scene.plate = bench.plates.front();
  scene.distance_m = bench.distance_m;
  const auto holder = std::make_shared<SceneHolder>(scene);
  const auto source = simulated_source(model, holder, "1");
  const auto target = scene_target(holder, bench.plates);
  ListedSchedule schedule = schedule_of(bench);
  return measure(*source, *target, observer, schedule, options, *bench.host, listener, stop);
}

}  // namespace todbench::test
