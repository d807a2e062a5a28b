// SPDX-License-Identifier: GPL-3.0-or-later
// A whole TOD on the simulated camera: two plates in four mountings at three contrasts in twelve phases, 5760 trials
// from 288 presentations, and three fits. Everything is built anew each time.
#include <benchmark/benchmark.h>

#include "tests/tod/measurement/measurement_bench.h"
#include "tod/psychometric/tod_curve.h"

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

/// How the cost grows: contrasts, plates (five sizes each) and phases, that is trials.
void simulated_tod_growth(benchmark::State& state) {
  test::SimulatedBench bench;
  bench.contrasts.clear();
  for (int i = 0; i < state.range(0); ++i) bench.contrasts.push_back(16.9 / (1 + i));
  bench.plates.resize(static_cast<std::size_t>(state.range(1)));
  bench.phases = static_cast<int>(state.range(2));
  bench.mountings.resize(2);
  const MeasurementOptions options = test::options_of(bench);
  for (auto _ : state) {
    TemplateObserver observer({}, triangle_alternatives());
    const auto result = test::run(bench, observer, options);
    benchmark::DoNotOptimize(tod_curve(result->trials, {}).value());
    state.counters["trials"] = static_cast<double>(result->trials.size());
  }
}
BENCHMARK(simulated_tod_growth)
    ->ArgNames({"contrasts", "plates", "phases"})
    ->ArgsProduct({{1, 2, 4}, {1}, {8}})
    ->ArgsProduct({{1}, {2}, {8}})
    ->ArgsProduct({{1}, {1}, {16, 32, 64}})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace todbench
