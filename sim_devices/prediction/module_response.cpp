// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/module_response.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "acquisition/base/try.h"

namespace todbench {
namespace {

/// Frames averaged, after those that the program remembers.
constexpr int averaged_frames = 4;

Result<cv::Mat1d> settled_mean(ModuleSensor& sensor, const cv::Mat1f& scene_k, int settle_frames,
                               const std::stop_token& stop) {
  cv::Mat1d sum;
  for (int i = 0; i < settle_frames + averaged_frames; ++i) {
    if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
    TODBENCH_TRY(const auto picture, sensor.picture(scene_k, static_cast<std::uint64_t>(i)));
    if (i < settle_frames) continue;
    cv::Mat1d now;
    picture.convertTo(now, CV_64F, 1.0 / averaged_frames);
    if (sum.empty())
      sum = now;
    else
      sum += now;
  }
  return sum;
}

}  // namespace

Result<double> module_response(const SensorSpec& spec, std::uint64_t seed, const TargetPlate& plate,
                               const ModuleResponseOptions& options, std::stop_token stop) {
  ModuleSensor sensor(spec, seed, {});
  const int settle_frames = sensor_module(spec)->settle_frames;
  PlateScene scene;
  scene.distance_m = options.distance_m;
  scene.background_k = spec.scene_temperature_k;
  TODBENCH_TRY(const auto empty, settled_mean(sensor, scene_picture_k(scene, spec), settle_frames, stop));
  scene.delta_t_k = options.delta_t_k;
  double sum = 0;
  int count = 0;
  // Mountings and phases as in contrast_response().
  for (const Mounting mounting : all_mountings) {
    for (const double phase : {0.0, 0.5}) {
      scene.plate = mounted(plate, mounting);
      scene.centre_px = {phase, -phase};
      TODBENCH_TRY(const auto picture, settled_mean(sensor, scene_picture_k(scene, spec), settle_frames, stop));
      const cv::Mat1d signal = (picture - empty) / options.delta_t_k;
      const auto found = register_plate(signal, scene.plate, options.registration);
      if (!found) return fail("simulating the contrast of plate " + plate.name, found.error());
      const auto contrast = effective_contrast(signal, scene.plate, *found, options.min_reference_px, options.level);
      if (!contrast) return fail("simulating the contrast of plate " + plate.name, contrast.error());
      sum += contrast->value;
      ++count;
    }
  }
  return sum / count;
}

Result<std::vector<double>> module_transfer(ModuleSensor& sensor, const SensorSpec& spec,
                                            const std::vector<double>& cycles_per_pitch) {
  constexpr int fine = scene_samples_per_pitch;
  const int settle_frames = sensor_module(spec)->settle_frames, middle = spec.width / 2;
  const cv::Size size(spec.width * fine, spec.height * fine);
  TODBENCH_TRY(const auto empty, settled_mean(sensor, cv::Mat1f(size, 0.0F), settle_frames, {}));
  // Indexed by the distance of the edge left of a pitch's first sample, in scene samples, from -fine middle - fine + 1.
  std::vector<double> response(static_cast<std::size_t>(size.width));
  for (int shift = 0; shift < fine; ++shift) {
    cv::Mat1f edge(size, 0.0F);
    edge.colRange(middle * fine + shift, size.width) = 1.0F;
    TODBENCH_TRY(const auto seen, settled_mean(sensor, edge, settle_frames, {}));
    const cv::Mat1d added = seen - empty;
    for (int column = 0; column < spec.width; ++column)
      response[static_cast<std::size_t>(column * fine + fine - 1 - shift)] = cv::mean(added.col(column))[0];
  }
  std::vector<double> moduli;
  for (const double f : cycles_per_pitch) {
    std::complex<double> sum = 0;
    for (std::size_t i = 1; i < response.size(); ++i)
      sum +=
          (response[i] - response[i - 1]) * std::polar(1.0, -2 * std::numbers::pi * f / fine * static_cast<double>(i));
    // A sample of the scene is the mean over a square.
    const double half = std::numbers::pi * f / fine;
    moduli.push_back(std::abs(sum) * (f == 0 ? 1 : std::abs(std::sin(half) / half)));
  }
  return moduli;
}

}  // namespace todbench
