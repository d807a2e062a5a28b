// SPDX-License-Identifier: GPL-3.0-or-later
// Cubes of frames with known noise components.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "acquisition/base/rng.h"
#include "tod/measures/three_d_noise.h"

namespace todbench::test {

/// Normal components of these standard deviations about 8000 counts.
[[nodiscard]] inline std::vector<cv::Mat1d> simulated_cube(int frames, int rows, int columns, const ByComponent& sd,
                                                           std::uint64_t seed) {
  using enum NoiseComponent;
  const RandomStream random(seed, "3-D noise");
  const auto draw = [&](NoiseComponent component, int i, int j, int k) {
    const auto at = static_cast<std::uint64_t>((i * 1000 + j) * 1000 + k);
    return sd[component] * static_cast<double>(random.sub(static_cast<std::uint64_t>(component)).normal(at));
  };
  std::vector<cv::Mat1d> cube;
  for (int k = 0; k < frames; ++k) {
    cv::Mat1d frame(rows, columns);
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < columns; ++x) {
        frame(y, x) = 8000 + draw(t, k, 0, 0) + draw(v, 0, y, 0) + draw(h, 0, 0, x) + draw(tv, k, y, 0) +
                      draw(th, k, 0, x) + draw(vh, 0, y, x) + draw(tvh, k, y, x);
      }
    }
    cube.push_back(frame);
  }
  return cube;
}

}  // namespace todbench::test
