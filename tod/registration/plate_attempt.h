// SPDX-License-Identifier: GPL-3.0-or-later
// Attempt to match a picture to a plate in one mounting.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "tod/registration/blob_finder.h"
#include "tod/registration/layout_matching.h"
#include "tod/registration/plate_mapping.h"
#include "tod/registration/registration.h"

namespace todbench {

inline constexpr double first_blur_px = 0.45;  ///< initial blur: optics, detector and sampling of a focused camera
inline constexpr double searched_scale_range = 0.3;  ///< relative; wide enough to report a wrong scale
/// Smallest number of pairs of a match. Fewer blobs agree with any layout by chance.
inline constexpr int credible_pairs = 4;
/// Share of the large triangles that must have the direction stated by the plate.
inline constexpr double agreement_needed = 0.75;

/// Data common to all attempts at one scale. Picture and options must outlive the object.
struct PlateSearch {
  const cv::Mat1d& picture;
  const RegistrationOptions& options;
  std::array<std::vector<Blob>, 2> blobs;  ///< warm, cold
};

/// Match of the picture to the plate in one mounting.
struct PlateAttempt {
  Mounting mounting = Mounting::identity;
  double sign = 1;  ///< 1: matched to the warm blobs; -1: matched to the cold blobs
  std::vector<PlateTriangle> large;
  LayoutMatch match;
  std::vector<PlateTriangle> located;  ///< triangles with the stated orientation
  std::vector<cv::Point2d> pixels;     ///< centroids of these triangles in the picture
  int judged = 0;                      ///< large triangles whose orientation could be determined
  double blur_px = first_blur_px;
  [[nodiscard]] int pairs() const { return static_cast<int>(match.pairs.size()); }
  [[nodiscard]] bool agrees() const {
    return judged > 0 && static_cast<double>(located.size()) >= agreement_needed * judged;
  }
};

/// Finds the blobs that have the size of the large triangles at the expected scale. Precondition: there are large
/// triangles.
[[nodiscard]] PlateSearch search_for(const cv::Mat1d& picture, const TargetPlate& plate,
                                     const RegistrationOptions& options);

/// Matches the layout in one mounting to the warm blobs and to the cold blobs. Returns the better match, with the
/// orientations of the triangles. Empty: no match.
[[nodiscard]] std::optional<PlateAttempt> attempt_mounting(const PlateSearch& search, const TargetPlate& plate,
                                                           Mounting relative);

/// Improves mapping, positions and blur one after the other. Then excludes triangles at wrong positions, for example
/// because of a bad pixel or dirt, as long as enough triangles remain.
[[nodiscard]] FittedMapping refine_attempt(const PlateSearch& search, PlateAttempt& at);

/// Returns the positions of the triangles on the plate, in mm.
[[nodiscard]] std::vector<cv::Point2d> places_of(const std::vector<PlateTriangle>& triangles);

}  // namespace todbench
