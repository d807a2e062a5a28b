// SPDX-License-Identifier: GPL-3.0-or-later
// Assigns blobs to triangles by comparing the drawing's layout with the spots of a picture.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "tod/plate/target_plate.h"
#include "tod/registration/blob_finder.h"

namespace todbench {

/// Limits of the search for a layout.
struct MatchLimits {
  double expected_scale_px_per_mm = 0;
  double scale_range = 0.3;  ///< relative; wide enough to report a wrong scale instead of no match
  double rotation_range_deg = 20;
  cv::Size picture;
};

/// Triangles paired with blobs by one similarity (rotation, scale, translation; no reflection).
struct LayoutMatch {
  cv::Matx33d plate_to_pixel = cv::Matx33d::eye();         ///< mm -> pixels
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  ///< index of triangle, index of blob
  int missing = 0;                                         ///< number of triangles inside the picture without a blob
  /// Returns whether this match is better: more pairs, or equally many pairs with fewer missing triangles. Missing
  /// triangles are not weighed against pairs, because a layout shifted half out of the picture has no missing ones.
  [[nodiscard]] bool better_than(const LayoutMatch& other) const {
    if (pairs.size() != other.pairs.size()) return pairs.size() > other.pairs.size();
    return missing < other.missing;
  }
};

/// Returns the least-squares similarity. For one pair it is a translation with `default_scale` and without rotation.
/// Precondition: as many pixels as positions, at least one.
[[nodiscard]] cv::Matx33d fit_similarity(std::span<const cv::Point2d> plate_mm, std::span<const cv::Point2d> pixels,
                                         double default_scale);

/// Returns the best of the similarities that pairs of triangles and pairs of blobs suggest. The best one has the most
/// triangles with a blob of matching position, size and strength, then the fewest missing. Empty if no blob can be a
/// triangle of the layout.
[[nodiscard]] std::optional<LayoutMatch> match_layout(std::span<const PlateTriangle> triangles,
                                                      std::span<const Blob> blobs, const MatchLimits& limits);

}  // namespace todbench
