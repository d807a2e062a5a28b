// Sub-pixel phases of all triangles of a plate, chosen together.
#pragma once

#include <cstddef>
#include <opencv2/core/types.hpp>
#include <span>
#include <vector>

#include "tod/plate/target_plate.h"

namespace todbench {

/// A triangle as a group of presentations shows it before any shift. A group is what has shifts in common: a mounting.
struct PhasedTriangle {
  std::size_t group = 0;
  double size = 0;          ///< triangles of equal size are to see their phases evenly together; any unit
  Apex apex = Apex::up;     ///< and so are those of them that point alike
  cv::Point2d position_px;  ///< of the centroid; one that all triangles are displaced by does not matter
};

/// Triangles of a plate in one mounting, for a pixel of `pixel_mm` on the plate.
[[nodiscard]] std::vector<PhasedTriangle> phased_triangles(const TargetPlate& plate, Mounting mounting, double pixel_mm,
                                                           std::size_t group);

/// Shifts of every group, in pixels, in [0, 1)^2.
struct EvenPhases {
  std::vector<std::vector<cv::Point2d>> shifts;  ///< per group
  cv::Point2d cell[2];  ///< sides of the cell of the lattice: by it and its multiples a group may be shifted unnoticed
};

/// `count` shifts for each of `groups` > 0. Those of a group are a lattice, of all with that many points the one whose
/// shortest dual vector is longest: the mean of a function of the phase over it has no error from harmonics below
/// that, for every triangle by itself. The groups are displaced against each other so that the phases of each size, and
/// of each size and orientation, are as even as can be: least sum of squared wrap-around discrepancies (its Fourier
/// series, harmonics of the dual lattice), by descent over one group after the other. Deterministic; the beginning of
/// a group is even too, up to 2048 shifts. No triangles, or more than 2048, whose phases are even by their number:
/// displaced as one triangle would be.
[[nodiscard]] EvenPhases even_phases(std::span<const PhasedTriangle> triangles, std::size_t groups, int count);

/// Wrap-around L2 discrepancy of points on the unit torus (Hickernell 1998); integer parts do not count. That of n
/// independent points is 0.687 / sqrt(n) in the root mean square. Precondition: not empty.
[[nodiscard]] double wraparound_discrepancy(std::span<const cv::Point2d> points);

}  // namespace todbench
