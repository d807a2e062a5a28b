// SPDX-License-Identifier: GPL-3.0-or-later
// A picture to a program of the user's and back.
#include <benchmark/benchmark.h>
#include <signal.h>

#include "acquisition/base/rng.h"
#include "sim_devices/module/module_process.h"

namespace todbench {
namespace {

/// 320 x 240 numbers through pipes and the shipped example in C++, which sharpens them: 0.3 ms are allowed.
void exchange_with_module(benchmark::State& state) {
  ::signal(SIGPIPE, SIG_IGN);
  auto module = ModuleProcess::start({.command = TODBENCH_EXAMPLE_MODULE});
  cv::Mat1f picture(240, 320);
  RandomStream(1, "module benchmark").fill_normal({picture.ptr<float>(), picture.total()});
  if (!module || !module->exchange(picture)) return state.SkipWithError("the module cannot be started");
  for (auto _ : state) benchmark::DoNotOptimize(module->exchange(picture).value());
}
BENCHMARK(exchange_with_module)->Unit(benchmark::kMicrosecond)->UseRealTime();

}  // namespace
}  // namespace todbench
