// SPDX-License-Identifier: GPL-3.0-or-later
// The simulated sensor: pictures of single triangles, whole frames, and the 75 % size without trials.
#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>

#include "sim_devices/prediction/direct_estimate.h"
#include "sim_devices/sensor/image_chain.h"
#include "sim_devices/sensor/scene_signal.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tests/sim_devices/reference.h"
#include "tests/sim_devices/test_plates.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

ImageChain chain_of(Accuracy accuracy) {
  const SensorSpec spec = test::sc2000();
  return {spec, full_plan(spec, {}, {}), accuracy};
}

/// Optics and detector on the lattice: once per sensor, accuracy and period.
void transfer_table(benchmark::State& state, Accuracy accuracy) {
  const Polygon shape = triangle(1.6, Apex::up);
  for (auto _ : state) benchmark::DoNotOptimize(chain_of(accuracy).image(shape));
}
BENCHMARK_CAPTURE(transfer_table, draft, Accuracy::draft())->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(transfer_table, normal, Accuracy::normal())->Unit(benchmark::kMillisecond);

void degraded_triangle_256_phases(benchmark::State& state, Accuracy accuracy, double size_pitch) {
  const ImageChain chain = chain_of(accuracy);
  const Polygon shape = triangle(size_pitch, Apex::up);
  benchmark::DoNotOptimize(chain.image(shape));  // the table of optics and detector is there from now on
  // As far as the window of an observer reaches (hvs-1), and a pitch for the phases.
  const int reach = static_cast<int>(std::ceil(1.05 * size_pitch + 2)) + 2;
  for (auto _ : state) benchmark::DoNotOptimize(chain.image(shape).fine_image(chain.points_per_pitch(), reach));
}
BENCHMARK_CAPTURE(degraded_triangle_256_phases, draft_size_2_6, Accuracy::draft(), 2.6)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(degraded_triangle_256_phases, normal_size_1_6, Accuracy::normal(), 1.6)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(degraded_triangle_256_phases, normal_size_2_6, Accuracy::normal(), 2.6)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(degraded_triangle_256_phases, normal_size_5, Accuracy::normal(), 5.0)->Unit(benchmark::kMillisecond);

void degraded_triangle_spectrum(benchmark::State& state) {
  const ImageChain chain = chain_of(Accuracy::normal());
  const Polygon shape = triangle(2.6, Apex::up);
  benchmark::DoNotOptimize(chain.image(shape));
  for (auto _ : state) benchmark::DoNotOptimize(chain.image(shape));
}
BENCHMARK(degraded_triangle_spectrum)->Unit(benchmark::kMillisecond);

void degraded_triangle_fine_image(benchmark::State& state) {
  const ImageChain chain = chain_of(Accuracy::normal());
  const PolygonImage image = chain.image(triangle(2.6, Apex::up));
  for (auto _ : state) benchmark::DoNotOptimize(image.fine_image(chain.points_per_pitch()));
}
BENCHMARK(degraded_triangle_fine_image)->Unit(benchmark::kMillisecond);

/// One triangle of a frame, at any place between the pixels.
void degraded_triangle_one_phase(benchmark::State& state) {
  const PolygonImage image = chain_of(Accuracy::normal()).image(triangle(2.6, Apex::up));
  const int n = image.lattice().period;
  for (auto _ : state) benchmark::DoNotOptimize(image.sample({-n / 2 + 0.3, -n / 2 - 0.2}, 1, {n, n}));
}
BENCHMARK(degraded_triangle_one_phase)->Unit(benchmark::kMillisecond);

std::unique_ptr<const SensorModel> model_of_sc2000() {
  const SensorSpec spec = test::sc2000();
  return std::make_unique<const SensorModel>(spec, full_plan(spec, {}, {}), Accuracy::normal(), 1);
}

PlateScene scene_of_twenty_triangles() {
  PlateScene scene;
  scene.plate = test::two_plates().front();
  scene.delta_t_k = 1.93;
  return scene;
}

void exposure_static_scene(benchmark::State& state) {
  const auto model = model_of_sc2000();
  const PlateScene scene = scene_of_twenty_triangles();
  std::uint64_t index = 0;
  for (auto _ : state) benchmark::DoNotOptimize(model->expose(scene, index++));
}
BENCHMARK(exposure_static_scene)->Unit(benchmark::kMillisecond);

/// The plate has moved before every frame: twenty triangles are drawn anew at places between the pixels.
void exposure_new_scene(benchmark::State& state) {
  const auto model = model_of_sc2000();
  PlateScene scene = scene_of_twenty_triangles();
  std::uint64_t index = 0;
  for (auto _ : state) {
    scene.shift_mm.x = 1e-4 * static_cast<double>(index);
    benchmark::DoNotOptimize(model->expose(scene, index++));
  }
}
BENCHMARK(exposure_new_scene)->Unit(benchmark::kMillisecond);

/// Two hundred polygons of four to six corners all over a frame of 640 x 480.
FieldScene scene_of_200_polygons() {
  FieldScene scene;
  const RandomStream numbers(1, "benchmark.scene");
  for (std::uint64_t p = 0; p < 200; ++p) {
    const RandomStream own = numbers.sub(p);
    SceneRegion region;
    const cv::Point2d middle(300 * own.uniform(0) - 150, 220 * own.uniform(1) - 110);
    const int corners = 4 + static_cast<int>(p % 3);
    const double size = 3 + 17 * own.uniform(2);
    for (int k = 0; k < corners; ++k) {
      const double angle = 2 * 3.14159265358979 * (k + 0.7 * own.uniform(static_cast<std::uint64_t>(10 + k))) / corners;
      region.outline_m.push_back(middle + size * cv::Point2d(std::cos(angle), std::sin(angle)));
    }
    region.temperature_k = 295 + 10 * own.uniform(3);
    scene.regions.push_back(region);
  }
  return scene;
}

/// At the first frame of a sensor its tables are made; they are kept.
void scene_of_200_polygons_640x480(benchmark::State& state) {
  SensorSpec spec = test::sc2000();
  spec.width = 640;
  spec.height = 480;
  const SensorPlan plan = full_plan(spec, {}, {});
  const FieldScene scene = scene_of_200_polygons();
  const RadianceScale scale{};
  auto imager = std::make_unique<const SceneImager>(spec, plan, Accuracy::normal());
  double range_m = 400;
  for (auto _ : state) {
    if (state.range(0) != 0) imager = std::make_unique<const SceneImager>(spec, plan, Accuracy::normal());
    range_m += 1e-3;
    benchmark::DoNotOptimize(scene_signal_k(*imager, spec, scene, scale, {.range_m = range_m}, {640, 480}).value());
  }
}
BENCHMARK(scene_of_200_polygons_640x480)->ArgName("first")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

/// Three contrasts, template banks and transfer tables included.
void direct_estimate_three_contrasts(benchmark::State& state, Accuracy accuracy) {
  const SensorSpec spec = test::sc2000();
  const SensorPlan plan = full_plan(spec, {}, {});
  DirectEstimateOptions options;
  options.accuracy = accuracy;
  for (auto _ : state) {
    TemplateObserver observer({}, triangle_alternatives());
    benchmark::DoNotOptimize(direct_estimate(spec, plan, observer, {16.9, 1.93, 0.23}, options).value());
  }
}
BENCHMARK_CAPTURE(direct_estimate_three_contrasts, draft, Accuracy::draft())->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(direct_estimate_three_contrasts, tolerance_5_percent, Accuracy::for_tolerance(5))
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(direct_estimate_three_contrasts, tolerance_1_percent, Accuracy::for_tolerance(1))
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(direct_estimate_three_contrasts, normal, Accuracy::normal())->Unit(benchmark::kMillisecond);

/// How the cost grows: the first argument contrasts between 4 and 2 K, whose sizes are alike, with the second number of
/// draws.
void direct_estimate_growth(benchmark::State& state) {
  const SensorSpec spec = test::sc2000();
  const SensorPlan plan = full_plan(spec, {}, {});
  DirectEstimateOptions options;
  options.accuracy.noise_draws = static_cast<int>(state.range(1));
  std::vector<double> contrasts;
  for (int i = 0; i < state.range(0); ++i) contrasts.push_back(4.0 / (1 + i / 8.0));
  for (auto _ : state) {
    TemplateObserver observer({}, triangle_alternatives());
    benchmark::DoNotOptimize(direct_estimate(spec, plan, observer, contrasts, options).value());
  }
}
BENCHMARK(direct_estimate_growth)
    ->ArgNames({"contrasts", "draws"})
    ->ArgsProduct({{1, 2, 4, 8}, {600}})
    ->ArgsProduct({{1}, {1200, 2400, 4800}})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace todbench
