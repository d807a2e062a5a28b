// SPDX-License-Identifier: GPL-3.0-or-later
// Sub-pixel phases of all triangles of a plate, optimised together.
#pragma once

#include <cstddef>
#include <opencv2/core/types.hpp>
#include <span>
#include <vector>

#include "tod/plate/target_plate.h"

namespace todbench {

/// A triangle in a group of presentations, at shift 0. All triangles of a group (a mounting) have the same shifts.
struct PhasedTriangle {
  std::size_t group = 0;
  double size = 0;          ///< in any unit; the phases of all triangles of equal size are spread evenly together
  Apex apex = Apex::up;     ///< the phases of triangles of equal size and apex are also spread evenly
  cv::Point2d position_px;  ///< position of the centroid; a common displacement of all triangles has no effect
};

/// Returns the triangles of a plate in one mounting. `pixel_mm`: width and height of a pixel on the plate.
[[nodiscard]] std::vector<PhasedTriangle> phased_triangles(const TargetPlate& plate, Mounting mounting,
                                                           cv::Size2d pixel_mm, std::size_t group);

/// Shifts of every group, in pixels, in [0, 1)^2.
struct EvenPhases {
  std::vector<std::vector<cv::Point2d>> shifts;  ///< shifts of each group
  cv::Point2d cell[2];  ///< sides of the lattice cell; shifting a group by a multiple of a side has no effect
};

/// Returns the length of the shortest dual vector of the lattice of `count` > 0 phases. This length is the frequency,
/// in cycles per pixel, of the lowest harmonic of the pixel grid that does not cancel in the mean over the phases of a
/// group.
[[nodiscard]] double least_harmonic(int count);

/// Computes `count` shifts for each of `groups` > 0. The shifts of a group form a lattice. Of all lattices with `count`
/// points, the lattice whose shortest dual vector is longest is used. For every triangle, the mean of a function of the
/// phase over this lattice has no error from harmonics below the length of this vector. The groups are displaced
/// relative to each other so that the phases of each size, and of each size and orientation, are spread as evenly as
/// possible. The criterion is the sum of squared wrap-around discrepancies, computed from its Fourier series with the
/// harmonics of the dual lattice. The sum is minimised by descent, one group at a time. Deterministic. For up to 2048
/// shifts, the first shifts of a group are also evenly spread. The groups are displaced as for one triangle if there
/// are no triangles, or more than 2048, because the phases of so many triangles are always evenly spread.
[[nodiscard]] EvenPhases even_phases(std::span<const PhasedTriangle> triangles, std::size_t groups, int count);

}  // namespace todbench
