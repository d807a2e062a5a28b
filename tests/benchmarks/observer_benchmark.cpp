// SPDX-License-Identifier: GPL-3.0-or-later
// The template observer: building a bank, deciding, and the random numbers both rest on.
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "hvs/observer/template_observer.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

/// A noisy blurred spot: the time of a decision does not depend on what is in the patch; that of a graded one does,
/// since a sure one is not drawn for.
Patch noisy_patch(int side, double contrast_k = 1) {
  const RandomStream stream(1, "benchmark.patch");
  Patch patch{.kelvin = cv::Mat1d(side, side), .phase = {0, 0}, .noise_k = 0.07};
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const double x = column - (side - 1) / 2.0;
      const double y = row - (side - 1) / 2.0;
      const auto index = static_cast<std::uint64_t>(row * side + column);
      patch.kelvin(row, column) =
          300 + contrast_k * std::exp(-(x * x + y * y) / 4) + 0.07 * static_cast<double>(stream.normal(index));
    }
  }
  return patch;
}

/// hvs-2 at a display whose samples are 3 arcmin, with a background of 50 cd/m2.
TemplateObserverSpec viewer() {
  return {.name = "hvs-2",
          .internal_noise = 0,
          .sensor_noise_factor = 1.75,
          .eye = EyeParameters{},
          .window_margin_arcmin = 6,
          .display = ViewedDisplay{.pixel_pitch_mm = 0.8726647, .viewing_distance_m = 1, .luminance_white_cd_m2 = 100}};
}

void observer_decision(benchmark::State& state, const TemplateObserverSpec& spec, double size_samples) {
  TemplateObserver observer(spec, triangle_alternatives());
  const auto prepared = observer.prepare(size_samples, 1).value();
  const Patch patch = noisy_patch(prepared->window_samples());
  const RandomStream noise(1, "benchmark.observer");
  std::uint64_t trial = 0;
  for (auto _ : state) benchmark::DoNotOptimize(prepared->choose(patch, 1.0, noise.sub(trial++)));
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK_CAPTURE(observer_decision, size_1_6, TemplateObserverSpec{}, 1.6)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(observer_decision, size_2_6, TemplateObserverSpec{}, 2.6)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(observer_decision, size_5, TemplateObserverSpec{}, 5.0)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(observer_decision, eye_1_6, viewer(), 1.6)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(observer_decision, eye_2_6, viewer(), 2.6)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(observer_decision, eye_5, viewer(), 5.0)->Unit(benchmark::kMicrosecond);

/// Probabilities of the answers, 32 draws of the observer's noise for each: `draws`.
void observer_graded(benchmark::State& state, const TemplateObserverSpec& spec, double size_samples) {
  constexpr double contrast_k = 0.23;
  TemplateObserver observer(spec, triangle_alternatives());
  const auto prepared = observer.prepare(size_samples, 1).value();
  const Patch patch = noisy_patch(prepared->window_samples(), contrast_k);
  const RandomStream noise(1, "benchmark.observer");
  std::uint64_t trial = 0;
  double draws = 0;
  for (auto _ : state) {
    GradedChoice graded = prepared->judge(patch, contrast_k, noise.sub(trial++), 32);
    benchmark::DoNotOptimize(graded);
    draws += graded.answers.draws;
  }
  state.SetItemsProcessed(state.iterations());
  state.counters["draws"] = benchmark::Counter(draws, benchmark::Counter::kAvgIterations);
}
BENCHMARK_CAPTURE(observer_graded, size_1_6, TemplateObserverSpec{}, 1.6)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(observer_graded, size_2_6, TemplateObserverSpec{}, 2.6)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(observer_graded, size_5, TemplateObserverSpec{}, 5.0)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(observer_graded, eye_1_6, viewer(), 1.6)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(observer_graded, eye_2_6, viewer(), 2.6)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(observer_graded, eye_5, viewer(), 5.0)->Unit(benchmark::kMicrosecond);

void template_bank(benchmark::State& state, const TemplateObserverSpec& spec, double size_samples) {
  const Alternatives alternatives = triangle_alternatives();
  for (auto _ : state) benchmark::DoNotOptimize(TemplateBank::build(spec, alternatives, size_samples, 1).value());
}
BENCHMARK_CAPTURE(template_bank, size_1_6, TemplateObserverSpec{}, 1.6)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(template_bank, size_2_6, TemplateObserverSpec{}, 2.6)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(template_bank, size_5, TemplateObserverSpec{}, 5.0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(template_bank, eye_1_6, viewer(), 1.6)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(template_bank, eye_5, viewer(), 5.0)->Unit(benchmark::kMillisecond);

/// As many as a frame of 320 x 240 needs.
void normal_numbers(benchmark::State& state) {
  const RandomStream stream(1, "benchmark.normal");
  std::vector<float> numbers(std::size_t{320} * 240);
  std::uint64_t index = 0;
  for (auto _ : state) {
    stream.sub(index++).fill_normal(numbers);
    benchmark::DoNotOptimize(numbers.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(numbers.size()));
}
BENCHMARK(normal_numbers)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace todbench
