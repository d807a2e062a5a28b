// Which blob is which triangle: the drawing's layout against the spots of a picture.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "tod/plate/target_plate.h"
#include "tod/registration/blob_finder.h"

namespace todbench {

/// Where to look for a layout.
struct MatchLimits {
  double expected_scale_px_per_mm = 0;
  double scale_range = 0.3;  ///< relative, wide enough to name a wrong scale instead of finding nothing
  double rotation_range_deg = 20;
  cv::Size picture;
};

/// Triangles paired with blobs under one similarity (turn, scale, move; no reflection).
struct LayoutMatch {
  cv::Matx33d plate_to_pixel = cv::Matx33d::eye();         ///< mm -> pixels
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  ///< index of triangle, index of blob
  int missing = 0;                                         ///< triangles that should be in the picture and have no blob
  /// More pairs are better; among as many, fewer missing. Missing ones do not weigh against pairs: a layout pushed half
  /// out of the picture has none.
  [[nodiscard]] bool better_than(const LayoutMatch& other) const {
    if (pairs.size() != other.pairs.size()) return pairs.size() > other.pairs.size();
    return missing < other.missing;
  }
};

/// The similarity of least squares. One pair: the move alone, at `default_scale` and without rotation.
/// Precondition: as many pixels as places, at least one.
[[nodiscard]] cv::Matx33d fit_similarity(std::span<const cv::Point2d> plate_mm, std::span<const cv::Point2d> pixels,
                                         double default_scale);

/// The best similarity among those that pairs of triangles and pairs of blobs suggest: most triangles with a blob of
/// fitting place, size and strength, less those that are missing. Nothing when no blob can be a triangle of the layout.
[[nodiscard]] std::optional<LayoutMatch> match_layout(std::span<const PlateTriangle> triangles,
                                                      std::span<const Blob> blobs, const MatchLimits& limits);

}  // namespace todbench
