// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of stars of sectors whose MTF across each edge is known exactly.
#pragma once

#include <cmath>
#include <vector>

#include "tests/tod/measures/edge_picture.h"

namespace todbench::test {

/// Sectors between lines through a centre. Away from the centre the picture is that of each line alone.
struct StarPicture {
  std::vector<double> lines_deg{5, 50, 95, 140};
  cv::Point2d centre{150.3, 99.6};
  double radius = 80, blur_sigma_pitch = 0.4;
  cv::Size size{300, 200};

  [[nodiscard]] EdgePicture edge_of(double normal_deg) const {
    return {.blur_sigma_pitch = blur_sigma_pitch, .angle_deg = normal_deg};
  }
  [[nodiscard]] cv::Mat1d picture(double noise = 0, std::uint64_t seed = 1) const {
    cv::Mat1d out(size, 0.5);
    const RandomStream random(seed, "star noise");
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const cv::Point2d at = cv::Point2d(x, y) - centre;
        double sign = 1;
        for (const double line : lines_deg) {
          const EdgePicture edge = edge_of(line + 90);
          sign *= 2 * edge.profile(at.x * edge.cosine() + at.y * edge.sine()) - 1;
        }
        if (std::hypot(at.x, at.y) < radius) out(y, x) = 0.5 + 0.5 * sign;
        out(y, x) += noise * static_cast<double>(random.normal(static_cast<std::uint64_t>(y * size.width + x)));
      }
    }
    return out;
  }
};

}  // namespace todbench::test
