// SPDX-License-Identifier: GPL-3.0-or-later
// Workshop drawing of a plate as a value, in millimetres at scale 1:1: cut-outs, dimensions, table, title block.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "tod/plate/target_plate.h"

namespace todbench {

/// Purpose of a line. The purpose is also the name of the layer of the line in the file.
enum class SheetLayer { cut, dimension, text };
/// Returns the name of the layer, in capitals.
[[nodiscard]] std::string_view to_string(SheetLayer layer);

/// Line through points. A closed line returns to its first point.
struct SheetLine {
  SheetLayer layer = SheetLayer::cut;
  std::vector<cv::Point2d> points_mm;
  bool closed = false;
};

/// One line of text. `at_mm` is the left end of its baseline.
struct SheetText {
  cv::Point2d at_mm;
  double height_mm = 2.5;  ///< height of a capital letter
  std::string text;
};

/// Drawing of a plate. The origin is the centre of the plate, x right, y down, as the camera sees the plate in identity
/// mounting. The layer `cut` contains only the outlines of the plate and of its cut-outs.
struct PlateSheet {
  std::string title;
  double left_mm = 0, top_mm = 0;  ///< corner of the sheet of paper
  double width_mm = 0, height_mm = 0;
  std::vector<SheetLine> lines;
  std::vector<SheetText> texts;
};

/// Cut-out with the numbers that the workshop needs.
struct CutOutRow {
  std::string name;
  std::string shape;  ///< "triangle, apex up", "rectangle", "bar"
  cv::Point2d position_mm;
  double size_mm = 0;            ///< triangles: square root of the area; otherwise the shorter side
  double side_mm = 0;            ///< triangles: side; otherwise the longer side
  double angle_deg = 0;          ///< angle of rectangles and bars, clockwise
  double edge_tolerance_mm = 0;  ///< largest displacement of all edges outwards or inwards
  Polygon outline_mm;
};
/// Returns the cut-outs in the order of the plate: triangles, rectangles, bars. `size_percent`: permitted error of a
/// size. If all edges of an equilateral triangle are displaced by d, its size S changes by the share d / (3^(-3/4) S).
/// The tolerance of an edge is therefore size_percent of 0.4387 S. For rectangles and bars the tolerance is
/// size_percent of half the shorter side.
[[nodiscard]] std::vector<CutOutRow> cut_out_rows(const TargetPlate& plate, double size_percent);

/// Relative errors of the size of a triangle, in percent. An error of all sizes changes the acuity by the same
/// percentage.
struct SizeErrors {
  double edges_percent = 0;    ///< all edges displaced outwards by d: d / (0.4387 S), in which S is the size
  double corners_percent = 0;  ///< corners rounded with a radius r: -1.027 (r / S)^2, not above 0
  /// Straight walls of a sheet, seen from the distance of observation, at the position of the triangle; not above 0.
  double sheet_percent = 0;
};
/// Errors of manufacture, and the distance of observation.
struct MakingErrors {
  double edge_mm = 0.01;
  double corner_radius_mm = 0.1;
  double thickness_mm = 1;
  double distance_m = 2;
};
/// Returns the errors for a triangle. A camera at the distance D looks through a sheet of thickness t with straight
/// walls. The camera sees the intersection of the front outline with the back outline. The back outline is shifted by t
/// r / D towards the centre of the plate, where r is the distance of the triangle from the centre.
[[nodiscard]] SizeErrors size_errors(const PlateTriangle& triangle, const MakingErrors& errors);

/// Returns the drawing. Errors: `invalid_input` (a plate without cut-outs).
[[nodiscard]] Result<PlateSheet> plate_sheet(const TargetPlate& plate, double size_percent);

}  // namespace todbench
