// SPDX-License-Identifier: GPL-3.0-or-later
// The emulated laboratory at full rate: its GigE camera through the Aravis back end, every frame taken for a minute.
// One such camera per host (the control port of GigE Vision is fixed): the benchmark is skipped when the port is taken.
#include <benchmark/benchmark.h>
#include <time.h>

#include "acquisition/aravis/aravis_backend.h"
#include "sim_devices/lab/laboratory.h"
#include "tests/sim_devices/reference.h"
#include "tests/sim_devices/test_plates.h"

namespace todbench {
namespace {

double cpu_seconds(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Counters: frames lost (gaps of the sequence) and incomplete, and processor time over wall time of the thread that
/// takes the frames and of the whole process, which is camera, both ends of the network and receiver.
void emulated_camera_one_minute_at_50_hz(benchmark::State& state) {
  constexpr int frames = 3000;
  LaboratoryOptions options;
  options.sensor = test::sc2000();
  options.plan = full_plan(options.sensor, {}, {});
  options.plates = test::two_plates();
  options.sensor.frame_rate_hz = 50;
  const auto laboratory = Laboratory::start(options);
  if (!laboratory) return state.SkipWithError(laboratory.error().message.c_str());
  const auto source = aravis_backend()->open("gige:" + (*laboratory)->camera_address());
  if (!source) return state.SkipWithError(source.error().message.c_str());
  std::uint64_t lost = 0;
  std::uint64_t incomplete = 0;
  for (auto _ : state) {
    if (const auto started = (*source)->start(); !started) return state.SkipWithError(started.error().message.c_str());
    std::optional<std::uint64_t> last;
    const double wall = cpu_seconds(CLOCK_MONOTONIC);
    const double thread = cpu_seconds(CLOCK_THREAD_CPUTIME_ID);
    const double process = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
    for (int i = 0; i < frames; ++i) {
      const auto frame = (*source)->next(std::chrono::seconds(2));
      if (!frame) return state.SkipWithError(frame.error().message.c_str());
      if (last) lost += frame->sequence - *last - 1;
      last = frame->sequence;
      if (frame->status != FrameStatus::complete) ++incomplete;
    }
    const double elapsed = cpu_seconds(CLOCK_MONOTONIC) - wall;
    (*source)->stop();
    state.counters["thread_cpu_percent"] = 100 * (cpu_seconds(CLOCK_THREAD_CPUTIME_ID) - thread) / elapsed;
    state.counters["process_cpu_percent"] = 100 * (cpu_seconds(CLOCK_PROCESS_CPUTIME_ID) - process) / elapsed;
    state.counters["frames_per_s"] = frames / elapsed;
  }
  state.counters["frames_lost"] = static_cast<double>(lost);
  state.counters["frames_incomplete"] = static_cast<double>(incomplete);
}
BENCHMARK(emulated_camera_one_minute_at_50_hz)->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();

}  // namespace
}  // namespace todbench
