// SPDX-License-Identifier: GPL-3.0-or-later
// One psychometric fit with both intervals: profile likelihood and posterior.
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "tod/psychometric/psychometric_fit.h"

namespace todbench {
namespace {

/// Ten sizes with 16 trials each, as in the human experiment of Bijl, Hogervorst and Vos: the expected counts of
/// threshold 1.6, slope 3.5, lapse 0.01.
std::vector<Level> ten_sizes() {
  std::vector<Level> levels;
  for (int i = 0; i < 10; ++i) {
    const double size = 0.8 * std::pow(1.17, i);
    levels.push_back({size, std::round(16 * psychometric(PsychometricForm::size, size, 1.6, 3.5, 0.01)), 16, -1});
  }
  return levels;
}

void fit(benchmark::State& state, const FitOptions& options) {
  const std::vector<Level> levels = ten_sizes();
  for (auto _ : state) benchmark::DoNotOptimize(fit_psychometric(levels, options).value());
}
BENCHMARK_CAPTURE(fit, fixed_lapse, FitOptions{.fixed_lapse = 0.01})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(fit, free_lapse, FitOptions{.fixed_lapse = std::nullopt})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(fit, free_lapse_acuity_form,
                  FitOptions{.form = PsychometricForm::acuity, .fixed_lapse = std::nullopt})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(fit, free_lapse_without_posterior, FitOptions{.fixed_lapse = std::nullopt, .with_posterior = false})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace todbench
