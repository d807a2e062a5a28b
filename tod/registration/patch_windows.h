// The windows that observers look through, on the plate and in the picture.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "hvs/observer/observer.h"
#include "tod/plate/target_plate.h"
#include "tod/registration/registration.h"

namespace todbench {

/// A square window of even side whose centre is a corner between four pixels, as near the target's centroid as
/// possible.
struct PatchWindow {
  cv::Rect pixels;
  cv::Point2d phase;  ///< centroid minus window centre, each in [-0.5, 0.5)
};

/// Window of `side` pixels (even) round a centroid in pixel coordinates (pixel centres at integers).
[[nodiscard]] PatchWindow patch_window(cv::Point2d centroid_px, int side);

/// A triangle whose window cannot be used, and why.
struct WindowProblem {
  std::string triangle;
  std::string reason;
};

/// Triangles of a mounted plate whose window, widened by the observer's search and half a pixel, touches a neighbour
/// (whose edge counts 1.5 px further out for blur) at `scale_px_per_mm`. `sides` and `search` belong to the triangles
/// in order.
[[nodiscard]] std::vector<WindowProblem> touching_windows(const TargetPlate& plate, double scale_px_per_mm,
                                                          const std::vector<int>& sides, double search_px);

/// Triangles whose window leaves a picture of this size, also when the plate moves by up to a pixel.
[[nodiscard]] std::vector<WindowProblem> windows_out_of_picture(const TargetPlate& mounted_plate,
                                                                const Registration& registration,
                                                                const std::vector<int>& sides, cv::Size picture);

}  // namespace todbench
