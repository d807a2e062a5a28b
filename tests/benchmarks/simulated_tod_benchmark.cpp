// A whole TOD on the simulated camera: two plates in four mountings at three contrasts in twelve phases, 5760 trials
// from 288 presentations, and three fits. Everything is built anew each time.
#include <benchmark/benchmark.h>

#include "tests/sim_devices/measurement_bench.h"
#include "tod/tod_curve.h"

namespace todbench {
namespace {

void simulated_tod(benchmark::State& state) {
  test::SimulatedBench bench;
  bench.phases = 12;
  const MeasurementOptions options = test::options_of(bench);
  for (auto _ : state) {
    TemplateObserver observer({}, triangle_alternatives());
    const auto result = test::run(bench, observer, options);
    benchmark::DoNotOptimize(tod_curve(result->trials, {}).value());
    state.counters["trials"] = static_cast<double>(result->trials.size());
    state.counters["frames"] = static_cast<double>(result->frames_used);
  }
}
BENCHMARK(simulated_tod)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace todbench
