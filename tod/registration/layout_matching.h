// SPDX-License-Identifier: GPL-3.0-or-later
// Assigns the spots (blobs) of a picture to triangles by comparison with the layout of the drawing.
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
  double scale_range = 0.3;  ///< relative range of scales; wide enough to report a wrong scale instead of no match
  double rotation_range_deg = 20;
  cv::Size picture;
};

/// Triangles paired with blobs by one similarity: rotation, scale and translation, without reflection.
struct LayoutMatch {
  cv::Matx33d plate_to_pixel = cv::Matx33d::eye();         ///< mm -> pixels
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  ///< index of triangle, index of blob
  int missing = 0;                                         ///< number of triangles inside the picture without a blob
  /// Returns whether this match is better: more pairs, or the same number of pairs and fewer missing triangles. The
  /// number of pairs has priority, because a layout that is shifted half out of the picture has only a few missing
  /// triangles.
  [[nodiscard]] bool better_than(const LayoutMatch& other) const {
    if (pairs.size() != other.pairs.size()) return pairs.size() > other.pairs.size();
    return missing < other.missing;
  }
};

/// Returns the least-squares similarity. For one pair it is a translation with `default_scale` and without rotation.
/// Precondition: `plate_mm` and `pixels` have the same number of positions, at least one.
[[nodiscard]] cv::Matx33d fit_similarity(std::span<const cv::Point2d> plate_mm, std::span<const cv::Point2d> pixels,
                                         double default_scale);

/// Returns the best match (LayoutMatch::better_than()). The candidates are the similarities that map a pair of
/// triangles to a pair of blobs. A triangle is paired with a blob of matching position, size and strength. Empty if no
/// blob can be a triangle of the layout.
[[nodiscard]] std::optional<LayoutMatch> match_layout(std::span<const PlateTriangle> triangles,
                                                      std::span<const Blob> blobs, const MatchLimits& limits);

}  // namespace todbench
