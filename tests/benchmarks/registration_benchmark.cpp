// SPDX-License-Identifier: GPL-3.0-or-later
// Finding the plate in a picture, following it, and reading its contrast.
#include <benchmark/benchmark.h>

#include "sim_devices/prediction/contrast_response.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tests/sim_devices/reference.h"
#include "tests/sim_devices/test_plates.h"
#include "tod/registration/registration.h"

namespace todbench {
namespace {

struct PlateInPicture {
  TargetPlate plate = test::two_plates().front();
  cv::Mat1d picture;
  RegistrationOptions options;
  PlateInPicture() {
    const SensorSpec spec = test::sc2000();
    PlateScene scene;
    scene.plate = plate;
    scene.delta_t_k = 16.9;
    picture = SensorModel(spec, full_plan(spec, {}, {}), Accuracy::normal(), 1).picture(scene, 0);
    options.expected_scale_px_per_mm = 1 / (scene.distance_m * spec.ifov_mrad());
  }
};

void registration(benchmark::State& state) {
  const PlateInPicture in;
  for (auto _ : state) benchmark::DoNotOptimize(register_plate(in.picture, in.plate, in.options).value());
}
BENCHMARK(registration)->Unit(benchmark::kMillisecond);

void plate_shift(benchmark::State& state) {
  const PlateInPicture in;
  const Registration where = register_plate(in.picture, in.plate, in.options)->moved({1.7, -2.2});
  for (auto _ : state) benchmark::DoNotOptimize(measure_shift(in.picture, in.plate, where, in.options, 6).value());
}
BENCHMARK(plate_shift)->Unit(benchmark::kMillisecond);

void contrast_of_plate(benchmark::State& state) {
  const PlateInPicture in;
  const Registration where = register_plate(in.picture, in.plate, in.options).value();
  for (auto _ : state) benchmark::DoNotOptimize(effective_contrast(in.picture, in.plate, where, 4).value());
}
BENCHMARK(contrast_of_plate)->Unit(benchmark::kMillisecond);

/// Eight simulated pictures, registered and read; once per plate and run. A new sensor model every time.
void contrast_response_of_plate(benchmark::State& state) {
  const PlateInPicture in;
  const SensorSpec spec = test::sc2000();
  for (auto _ : state) {
    const SensorModel model(spec, full_plan(spec, {}, {}), Accuracy::normal(), 1);
    benchmark::DoNotOptimize(contrast_response(model, in.plate, 2, 4, in.options).value());
  }
}
BENCHMARK(contrast_response_of_plate)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace todbench
