// SPDX-License-Identifier: GPL-3.0-or-later
// Sub-pixel phases of all triangles of a plate, optimised together.
#pragma once

#include <cstddef>
#include <opencv2/core/types.hpp>
#include <span>
#include <vector>

#include "tod/plate/target_plate.h"

namespace todbench {

/// A triangle in a group of presentations before any shift. A group (a mounting) has common shifts.
struct PhasedTriangle {
  std::size_t group = 0;
  double size = 0;          ///< in any unit; the phases of triangles of equal size are even together
  Apex apex = Apex::up;     ///< the phases of triangles of equal size and apex are even, too
  cv::Point2d position_px;  ///< position of the centroid; a common displacement of all triangles has no effect
};

/// Returns the triangles of a plate in one mounting. `pixel_mm`: width and height of a pixel on the plate.
[[nodiscard]] std::vector<PhasedTriangle> phased_triangles(const TargetPlate& plate, Mounting mounting,
                                                           cv::Size2d pixel_mm, std::size_t group);

/// Shifts of every group, in pixels, in [0, 1)^2.
struct EvenPhases {
  std::vector<std::vector<cv::Point2d>> shifts;  ///< per group
  cv::Point2d cell[2];  ///< sides of the lattice cell: a shift of a group by a multiple of a side has no effect
};

/// Returns the lowest harmonic of the pixel grid, in cycles per pixel, that the mean over `count` > 0 phases of a group
/// contains: the length of the shortest dual vector.
[[nodiscard]] double least_harmonic(int count);

/// Computes `count` shifts for each of `groups` > 0. The shifts of a group form a lattice. Of all lattices with that
/// many points, it is the one with the longest shortest dual vector: for every triangle, the mean of a function of the
/// phase over the lattice has no error from harmonics below the length of this vector. The groups are displaced
/// relative to each other so that the phases of each size, and of each size and orientation, are as even as possible.
/// The criterion is the smallest sum of squared wrap-around discrepancies (its Fourier series, harmonics of the dual
/// lattice), found by descent over one group after another. Deterministic. The first shifts of a group are also even,
/// for up to 2048 shifts. Without triangles, or with more than 2048, whose large number makes their phases even, the
/// groups are displaced as for one triangle.
[[nodiscard]] EvenPhases even_phases(std::span<const PhasedTriangle> triangles, std::size_t groups, int count);

}  // namespace todbench
