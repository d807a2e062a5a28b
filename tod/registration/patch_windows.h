// SPDX-License-Identifier: GPL-3.0-or-later
// Windows of the observer, on the plate and in the picture.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "hvs/observer/observer.h"
#include "tod/plate/target_plate.h"
#include "tod/registration/registration.h"

namespace todbench {

/// A square window with an even number of pixels on a side. The centre of the window is the corner of four pixels that
/// is nearest to the centroid of the target.
struct PatchWindow {
  cv::Rect pixels;
  cv::Point2d phase;  ///< centroid minus window centre, each in [-0.5, 0.5)
};

/// Returns the window of `side` pixels (even) round a centroid in pixel coordinates (pixel centres at integers).
[[nodiscard]] PatchWindow patch_window(cv::Point2d centroid_px, int side);

/// A triangle whose window is too close to a neighbouring triangle.
struct TouchingWindow {
  std::string triangle, neighbour;
  int side_px = 0;          ///< side of the window
  double gap_px = 0;        ///< distance between the neighbouring triangle and the window, including the search range
  double least_gap_px = 0;  ///< distance that is required because of blur
};

/// A triangle whose window is not entirely in the picture.
struct WindowOutOfPicture {
  std::string triangle;
  cv::Rect window;
  cv::Size picture;
};

/// Returns a sentence, for example "TRIANGLE: its window of 20 px comes within 0.3 px of ..."
[[nodiscard]] std::string sentence(const TouchingWindow& window);
[[nodiscard]] std::string sentence(const WindowOutOfPicture& window);

/// Returns the triangles of a mounted plate whose window touches a neighbour at the expected scale and aspect of
/// `options`. For the test, the window is widened by `search_px`, the search range of the observer, plus half a pixel.
/// Because of blur, the neighbour is enlarged by 1.5 px on each side. `sides`: sides of the windows, in the order of
/// the triangles.
[[nodiscard]] std::vector<TouchingWindow> touching_windows(const TargetPlate& plate, const RegistrationOptions& options,
                                                           const std::vector<int>& sides, double search_px);

/// Returns the triangles whose window is partly outside a picture of this size, or would be outside after a motion of
/// the plate by up to a pixel.
[[nodiscard]] std::vector<WindowOutOfPicture> windows_out_of_picture(const TargetPlate& mounted_plate,
                                                                     const Registration& registration,
                                                                     const std::vector<int>& sides, cv::Size picture);

}  // namespace todbench
