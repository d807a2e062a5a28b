// SPDX-License-Identifier: GPL-3.0-or-later
// Frames of a simulated camera behind a gain control of eight bits, and how often the contrast that their large
// triangles show holds the truth.
#pragma once

#include <algorithm>
#include <cmath>

#include "acquisition/base/rng.h"
#include "sim_devices/prediction/contrast_response.h"
#include "tests/tod/measurement/faulty_bench.h"
#include "tod/measurement/grey_levels.h"

namespace todbench::test {

/// Grey levels of counts: `gain` levels a count about `middle`, rounded, cut off at eight bits.
inline cv::Mat1w grey(const cv::Mat1w& counts, double gain, double middle) {
  cv::Mat1w levels(counts.size());
  std::transform(counts.begin(), counts.end(), levels.begin(), [&](std::uint16_t count) {
    return static_cast<std::uint16_t>(std::clamp(std::nearbyint(60 + gain * (count - middle)), 0.0, 255.0));
  });
  return levels;
}

struct GreyCase {
  double delta_t_k = 0;
  double levels_per_k = 0;
};

struct GreyCoverage {
  int frames = 0, held = 0;
  double mean_ratio = 0;  ///< estimate over truth
  double mean_half_width = 0;
  [[nodiscard]] double share() const { return static_cast<double>(held) / frames; }
};

/// `seeds` frames, each with a noise, a sampling phase and a level of its own.
inline GreyCoverage grey_coverage(const GreyCase& one, int seeds) {
  SimulatedBench bench;
  // Fine counts: rounding is that of the grey levels.
  bench.spec.kelvin_per_count = 0.001;
  bench.spec.offset_k = 270;
  bench.spec.bits = 16;
  const auto model =
      std::make_shared<const SensorModel>(bench.spec, full_plan(bench.spec, {}, {}), Accuracy::draft(), 1);
  PlateScene scene;
  scene.plate = bench.plates.front();
  scene.delta_t_k = one.delta_t_k;
  const double scale = 1 / (bench.distance_m * bench.spec.ifov_mrad());
  const RegistrationOptions looked_for{.expected_scale_px_per_mm = scale};
  const double response = contrast_response(*model, scene.plate, 2, 4, looked_for, {}, LevelEstimate::mean).value();
  const double truth = one.delta_t_k * one.levels_per_k * response;
  GreyCoverage out;
  for (int seed = 0; seed < seeds; ++seed) {
    const RandomStream random(static_cast<std::uint64_t>(seed), "grey");
    scene.centre_px = {random.uniform(0) - 0.5, random.uniform(1) - 0.5};
    Registration registration;
    registration.scale_px_per_mm = scale;
    const cv::Point2d origin =
        scene_pixel(scene, {0, 0}, bench.spec.ifov_mrad(), {bench.spec.width, bench.spec.height});
    registration.plate_to_pixel = {scale, 0, origin.x, 0, scale, origin.y, 0, 0, 1};
    const double gain = one.levels_per_k * bench.spec.kelvin_per_count;
    const double middle = (300 - bench.spec.offset_k) / bench.spec.kelvin_per_count + random.uniform(2) / gain;
    const auto exposed = static_cast<std::uint64_t>(2 * seed);
    const cv::Mat1w frame = grey(model->expose(scene, exposed), gain, middle);
    const cv::Mat1w next = grey(model->expose(scene, exposed + 1), gain, middle);
    cv::Mat1d a, b;
    frame.convertTo(a, CV_64F);
    next.convertTo(b, CV_64F);
    cv::Scalar mean, sd;
    cv::meanStdDev(b - a, mean, sd);
    const GreySteps steps = grey_steps(cv::min(frame, next), cv::max(frame, next), sd[0] / std::sqrt(2.0));
    const auto found = grey_contrast(a, scene.plate, registration, 4, steps);
    if (!found) continue;
    ++out.frames;
    out.held += std::abs(found->levels - truth) <= found->half_width() ? 1 : 0;
    out.mean_ratio += found->levels / truth / seeds;
    out.mean_half_width += found->half_width() / seeds;
  }
  return out;
}

}  // namespace todbench::test
