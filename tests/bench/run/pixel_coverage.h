// SPDX-License-Identifier: GPL-3.0-or-later
// Defects of a simulated sensor, which are known, against what the measure finds in its frames.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bench/plan/descriptions.h"
#include "sim_devices/sensor/effect_dead_pixels.h"
#include "sim_devices/sensor/pixel_faults.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tod/measures/pixel_defects.h"
#include "tod/measures/shading.h"

namespace todbench::testing {

/// Of many arrays together.
struct PixelCoverage {
  std::array<int, pixel_fault_kinds.size()> there{}, found{};  ///< by kind of fault
  int substituted = 0, substituted_found = 0;
  int live = 0;           ///< pixels without any fault
  int bad_by_chance = 0;  ///< of these, taken for bad
  int substituted_by_chance = 0;
  int not_tested = 0;  ///< kinds that could not be tested
};

struct PixelCamera {
  int width = 160, height = 120, frames = 64;
  double kelvin_per_count = 0.01;  ///< of a noise of 0.07 K
  double noise_correlation = 0, fixed_pattern_k = 0.03, line_noise_k = 0.02;
};

/// Array and frames of seed `seed`. Defects that touch one that the camera hides are left out of the count: it takes
/// them for its mean.
inline void add_pixel_coverage(PixelCoverage& sum, const PixelCamera& camera, std::uint64_t seed) {
  SensorSpec spec = *load_sensor("sc2000");
  spec.width = camera.width, spec.height = camera.height;
  spec.kelvin_per_count = camera.kelvin_per_count;
  spec.noise_correlation = camera.noise_correlation, spec.fixed_pattern_k = camera.fixed_pattern_k;
  spec.row_noise_k = spec.column_noise_k = camera.line_noise_k;
  spec.dead_pixel_share = 0.001, spec.defective_pixel_share = 0.002;
  spec.defect_seed = static_cast<int>(seed);
  const SensorModel model(spec, full_plan(spec, {}, {}), Accuracy::draft(), seed);
  const cv::Mat1f flat = cv::Mat1f::zeros(model.size());
  std::vector<cv::Mat1f> frames;
  for (int k = 0; k < camera.frames; ++k)
    frames.push_back(model.picture(flat, 0, spec.scene_temperature_k, static_cast<std::uint64_t>(k)));

  const auto found = pixel_defects(frames, {.unit_per_count = spec.kelvin_per_count}, {});

  if (!found) return;
  sum.not_tested += static_cast<int>(found->not_tested.size());
  cv::Mat1b hidden = dead_detectors({spec.width, spec.height}, spec.dead_pixel_share, {seed, "sensor.dead"});
  cv::Mat1b faulty(hidden.size(), std::uint8_t{0}), beside(hidden.size(), std::uint8_t{0});
  for (int y = 0; y < hidden.rows; ++y) {
    for (int x = 0; x < hidden.cols; ++x) {
      if (hidden(y, x) == 0) continue;
      for (int v = std::max(0, y - 1); v <= std::min(hidden.rows - 1, y + 1); ++v)
        for (int u = std::max(0, x - 1); u <= std::min(hidden.cols - 1, x + 1); ++u) beside(v, u) = 1;
    }
  }
  for (const PixelFault& fault : pixel_faults(spec)) {
    faulty(fault.detector) = 1;
    if (beside(fault.detector) != 0) continue;
    const auto kind = static_cast<std::size_t>(fault.kind);
    ++sum.there[kind];
    const PixelDefect expected =
        std::array{PixelDefect::stuck, PixelDefect::offset, PixelDefect::noisy, PixelDefect::blinking}[kind];
    if (found->of(expected)(fault.detector) != 0) ++sum.found[kind];
  }
  for (int y = 0; y < hidden.rows; ++y) {
    for (int x = 0; x < hidden.cols; ++x) {
      const bool replaced = found->of(PixelDefect::substituted)(y, x) != 0;
      if (hidden(y, x) != 0) {
        ++sum.substituted;
        if (replaced) ++sum.substituted_found;
      } else if (faulty(y, x) == 0) {
        ++sum.live;
        if (found->bad(y, x) != 0) ++sum.bad_by_chance;
        if (replaced) ++sum.substituted_by_chance;
      }
    }
  }
}

}  // namespace todbench::testing
