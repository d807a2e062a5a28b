// SPDX-License-Identifier: GPL-3.0-or-later
// An identification experiment: 24 targets in three aspects at 8 ranges, 2000 decisions each.
#include <benchmark/benchmark.h>

#include "bench/plan/target_sets.h"
#include "sim_devices/prediction/identification.h"
#include "tests/sim_devices/reference.h"

namespace todbench {
namespace {

/// Wall time, on as many threads as there are processors.
void identification_of_24_targets(benchmark::State& state) {
  const auto set = load_target_set("all-targets");
  IdentificationTask task;
  task.sensor = test::sc2000();
  task.plan = full_plan(task.sensor, {}, {});
  for (std::size_t t = 0; t < set->targets.size(); ++t) {
    IdentificationTarget target{set->targets[t].name, {}};
    for (const double azimuth_deg : set->azimuths_deg) target.aspects.push_back(scene_of(*set, t, azimuth_deg));
    task.targets.push_back(std::move(target));
  }
  for (const double range_m : {100.0, 150.0, 200.0, 300.0, 400.0, 600.0, 900.0, 1400.0})
    task.ranges.push_back({range_m, 1});
  for (auto _ : state) benchmark::DoNotOptimize(identify(task).value());
}
BENCHMARK(identification_of_24_targets)
    ->Iterations(1)
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kSecond);

}  // namespace
}  // namespace todbench
