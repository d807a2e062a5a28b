// SPDX-License-Identifier: GPL-3.0-or-later
// Sub-pixel phases of all triangles of a plate, chosen together.
#pragma once

#include <cstddef>
#include <opencv2/core/types.hpp>
#include <span>
#include <vector>

#include "tod/plate/target_plate.h"

namespace todbench {

/// A triangle of a group of presentations before any shift. A group (a mounting) shares its shifts.
struct PhasedTriangle {
  std::size_t group = 0;
  double size = 0;          ///< any unit; triangles of equal size get even phases together
  Apex apex = Apex::up;     ///< triangles of equal size and apex get even phases too
  cv::Point2d position_px;  ///< of the centroid; a common displacement of all triangles has no effect
};

/// Triangles of a plate in one mounting. `pixel_mm`: width and height of a pixel on the plate.
[[nodiscard]] std::vector<PhasedTriangle> phased_triangles(const TargetPlate& plate, Mounting mounting,
                                                           cv::Size2d pixel_mm, std::size_t group);

/// Shifts of every group, in pixels, in [0, 1)^2.
struct EvenPhases {
  std::vector<std::vector<cv::Point2d>> shifts;  ///< per group
  cv::Point2d cell[2];  ///< sides of the lattice cell: a shift of a group by a multiple of a side has no effect
};

/// Lowest harmonic of the pixel grid, in cycles per pixel, that the mean over `count` > 0 phases of a group contains:
/// the length of the shortest dual vector.
[[nodiscard]] double least_harmonic(int count);

/// Computes `count` shifts for each of `groups` > 0. The shifts of a group form a lattice: of all lattices with that
/// many points, the one whose shortest dual vector is longest. For every triangle, the mean of a function of the phase
/// over the lattice has no error from harmonics below the length of this vector. The groups are displaced relative to
/// each other so that the phases of each size, and of each size and orientation, are as even as possible: least sum of
/// squared wrap-around discrepancies (its Fourier series, harmonics of the dual lattice), by descent over one group
/// after the other. Deterministic. The first shifts of a group are even too, up to 2048 shifts. Without triangles, or
/// with more than 2048, whose phases are even by their number, the groups are displaced as for one triangle.
[[nodiscard]] EvenPhases even_phases(std::span<const PhasedTriangle> triangles, std::size_t groups, int count);

}  // namespace todbench
