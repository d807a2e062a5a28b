// SPDX-License-Identifier: GPL-3.0-or-later
// Assignment of blobs to triangles: the drawing's layout against the spots of a picture.
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

/// Triangles paired with blobs under one similarity (rotation, scale, translation; no reflection).
struct LayoutMatch {
  cv::Matx33d plate_to_pixel = cv::Matx33d::eye();         ///< mm -> pixels
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  ///< index of triangle, index of blob
  int missing = 0;                                         ///< triangles inside the picture without a blob
  /// More pairs are better; with equally many pairs, fewer missing triangles. Missing triangles are not weighed against
  /// pairs, because a layout pushed half out of the picture has none.
  [[nodiscard]] bool better_than(const LayoutMatch& other) const {
    if (pairs.size() != other.pairs.size()) return pairs.size() > other.pairs.size();
    return missing < other.missing;
  }
};

/// Least-squares similarity. With one pair: the translation alone, at `default_scale` and without rotation.
/// Precondition: as many pixels as places, at least one.
[[nodiscard]] cv::Matx33d fit_similarity(std::span<const cv::Point2d> plate_mm, std::span<const cv::Point2d> pixels,
                                         double default_scale);

/// The best of the similarities that pairs of triangles and pairs of blobs suggest: the most triangles with a blob of
/// matching place, size and strength, then the fewest missing. Empty if no blob can be a triangle of the layout.
[[nodiscard]] std::optional<LayoutMatch> match_layout(std::span<const PlateTriangle> triangles,
                                                      std::span<const Blob> blobs, const MatchLimits& limits);

}  // namespace todbench
