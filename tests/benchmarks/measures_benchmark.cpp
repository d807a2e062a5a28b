// SPDX-License-Identifier: GPL-3.0-or-later
// Single measures: the noise by direction of a whole recording, and the MTF of an edge.
#include <benchmark/benchmark.h>

#include <vector>

#include "acquisition/base/rng.h"
#include "tests/tod/measures/edge_picture.h"
#include "tod/measures/slanted_edge.h"
#include "tod/measures/three_d_noise.h"

namespace todbench {
namespace {

/// 128 frames of 240 x 320 pixels: 0.3 s and 200 MB are allowed.
void noise_of_cube(benchmark::State& state) {
  const RandomStream random(1, "noise benchmark");
  std::vector<cv::Mat1w> frames;
  for (int k = 0; k < 128; ++k) {
    cv::Mat1f noise(240, 320);
    random.sub(static_cast<std::uint64_t>(k)).fill_normal(std::span(noise.ptr<float>(), noise.total()));
    cv::Mat1w frame;
    cv::Mat1f(8000 + 5 * noise).convertTo(frame, CV_16U);
    frames.push_back(frame);
  }
  for (auto _ : state) {
    NoiseCube cube;
    for (const auto& frame : frames) (void)cube.add(frame);
    const NoiseTable table = cube.table().value();
    for (const NoiseComponent component : noise_components) benchmark::DoNotOptimize(estimate_of(table, component));
  }
}
BENCHMARK(noise_of_cube)->Unit(benchmark::kMillisecond);

/// 50 ms are allowed.
void mtf_of_edge(benchmark::State& state) {
  const cv::Mat1d picture = test::EdgePicture().noisy(0.01, 1);
  for (auto _ : state) benchmark::DoNotOptimize(slanted_edge(picture, {}).value());
}
BENCHMARK(mtf_of_edge)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace todbench
