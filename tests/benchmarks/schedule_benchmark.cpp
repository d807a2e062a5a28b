// SPDX-License-Identifier: GPL-3.0-or-later
// The next stimulus of the adaptive schedules.
#include <benchmark/benchmark.h>

#include <optional>
#include <vector>

#include "tests/sim_devices/test_plates.h"
#include "tod/psychometric/psychometric_fit.h"
#include "tod/schedule/adaptive_schedule.h"
#include "tod/schedule/psi_placement.h"

namespace todbench {
namespace {

/// One trial after the other: the size to ask at, the answer taken in. Runs of 160 trials from nothing, 10 sizes in the
/// range of a plate.
void psi_next_stimulus(benchmark::State& state) {
  const RandomStream stream(1, "benchmark.psi");
  std::uint64_t run = 0, trial = 160;
  std::optional<PsiPlacement> psi;
  for (auto _ : state) {
    if (trial == 160) {
      state.PauseTiming();
      psi.emplace(PsiOptions{.first_size = 0.5, .last_size = 10}, stream.sub(++run));
      trial = 0;
      state.ResumeTiming();
    }
    const double size = psi->next();
    const double right = psychometric(PsychometricForm::size, size, 1.6, 4, 0.0);
    psi->observe(size, static_cast<double>(stream.sub(run).uniform(++trial)) < right ? 1 : 0, 1);
  }
}
BENCHMARK(psi_next_stimulus)->Unit(benchmark::kMicrosecond);

/// One presentation of a plate after the other: what to show, and its twenty answers taken in.
void adaptive_next_presentation(benchmark::State& state) {
  const std::vector<TargetPlate> plates = test::two_plates();
  const RandomStream stream(1, "benchmark.adaptive");
  AdaptiveOptions options;
  options.stimuli.mountings.assign(all_mountings.begin(), all_mountings.end());
  options.stimuli.delta_t_k = {16.9, 1.93, 0.23};
  options.stimuli.phases = 4;
  options.stimuli.pixel_mm = 2.6;
  options.plates = plates;
  options.distance_m = 2;
  options.fit.fixed_lapse = 0.0;
  options.half_width_percent = 1;
  options.max_presentations = 96;
  for (const auto& plate : plates) options.stimuli.plates.push_back(plate.name);
  std::uint64_t run = 0, answer = 0;
  std::optional<AdaptiveSchedule> schedule;
  for (auto _ : state) {
    std::optional<TargetState> next;
    if (schedule) next = schedule->next();
    if (!next) {
      schedule.emplace(options, stream.sub(++run));
      next = schedule->next();
    }
    state.PauseTiming();
    std::vector<Trial> trials;
    const TargetPlate& shown = next->plate == plates.front().name ? plates.front() : plates.back();
    for (const auto& t : shown.triangles) {
      Trial trial;
      trial.plate = next->plate;
      trial.mounting = next->mounting;
      trial.triangle = t.name;
      trial.set_delta_t_k = trial.delta_t_k = next->delta_t_k;
      trial.size_mm = t.size_mm;
      trial.size_mrad = t.size_mm / options.distance_m;
      trial.truth = trial.answer = t.apex;
      const double right = psychometric(PsychometricForm::size, trial.size_mrad, 2.4, 4, 0.0);
      if (!(static_cast<double>(stream.uniform(++answer)) < right))
        trial.answer = static_cast<Apex>((static_cast<int>(t.apex) + 1) % 4);
      trials.push_back(trial);
    }
    state.ResumeTiming();
    schedule->observe(trials);
  }
}
BENCHMARK(adaptive_next_presentation)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace todbench
