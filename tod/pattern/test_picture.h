// SPDX-License-Identifier: GPL-3.0-or-later
// Test pictures for projectors, monitors and visible cameras. The pictures consist of known polygons; the level of a
// pixel is computed from the exact area that the polygons cover.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <variant>
#include <vector>

#include "acquisition/base/result.h"
#include "hvs/shape/polygon.h"
#include "tod/plate/target_plate.h"

namespace todbench {

/// Rows of four triangles. Each row contains each orientation once, in an order drawn from the seed; positions differ
/// in sub-pixel phase.
struct TodPicture {
  /// Square roots of area, one row for each size. Empty: as many sizes as fit into the picture, with a ratio of 1.205.
  std::vector<double> sizes_px;
  std::uint64_t seed = 1;
};
/// Groups of four bars (length to width 7 : 1), one vertical and one horizontal group for each frequency.
struct MrtdPicture {
  std::vector<double> frequencies_per_px{0.05, 0.1, 0.2, 0.3, 0.4, 0.5};
};
/// A straight edge through the middle, rotated from the vertical; the left side is dark.
struct EdgePicture {
  double angle_deg = 5;
};
/// A linear ramp, bright on the right. The level of a pixel is that at its centre, which equals the mean over the
/// pixel.
struct RampPicture {};
/// A Siemens star round the middle. The wedges extend to the nearest border and have straight outer ends; the first
/// wedge begins clockwise from the direction to the right.
struct SiemensPicture {
  int spokes = 36;
};
/// A uniform picture.
struct FlatPicture {
  double level = 0.5;
};
/// Pattern of a test picture.
using PictureKind = std::variant<TodPicture, MrtdPicture, EdgePicture, RampPicture, SiemensPicture, FlatPicture>;

/// Input of drawn_picture().
struct PictureRequest {
  cv::Size size;
  double low = 0, high = 1;  ///< levels of background and pattern, 0 to 1; not used for FlatPicture
  PictureKind kind;
};

/// Geometry of one group of bars. `x_px`, `y_px`: middle of the group, measured from the upper left corner of the
/// picture.
struct BarGroup {
  double frequency_per_px = 0, x_px = 0, y_px = 0;
  bool upright = true;  ///< the bars are parallel to y
};

/// A picture and the shapes in it.
struct TestPicture {
  cv::Mat1d levels;   ///< 0 to 1
  TargetPlate plate;  ///< plate of a TOD picture; one pixel is 1 mm, the origin is the middle of the picture
  std::vector<BarGroup> bars;
};

/// Draws a test picture. Errors: `invalid_input` (a picture that is too small for the pattern, invalid or equal levels,
/// a triangle that does not fit, bars of more than half a cycle per pixel, or a star of more than half a cycle per
/// pixel everywhere).
[[nodiscard]] Result<TestPicture> drawn_picture(const PictureRequest& request);

/// Returns the radius in pixels below which the spokes have more than half a cycle per pixel (Nyquist).
[[nodiscard]] double finest_radius_px(const SiemensPicture& star);
/// Returns the outline of a triangle of the plate in pixels from the upper left corner.
[[nodiscard]] Polygon outline_px(const PlateTriangle& triangle, cv::Size size);
/// Returns the outlines of the four bars of a group.
[[nodiscard]] std::vector<Polygon> outlines_px(const BarGroup& group);

}  // namespace todbench
