// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plate_drawing/plate_drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

constexpr double row_mm = 4.5;   // of the table and of notes
constexpr double text_mm = 2.5;  // ISO 3098: the smallest common height
constexpr double margin_left_mm = 35, margin_top_mm = 30, margin_bottom_mm = 20, frame_mm = 10;
constexpr double table_gap_mm = 15, table_width_mm = 170;

struct PaperFormat {
  std::string_view name;
  double width_mm, height_mm;
};
/// ISO 216, landscape.
constexpr std::array paper_formats{PaperFormat{"A4", 297, 210}, PaperFormat{"A3", 420, 297},
                                   PaperFormat{"A2", 594, 420}, PaperFormat{"A1", 841, 594},
                                   PaperFormat{"A0", 1189, 841}};

class SheetBuilder {
 public:
  explicit SheetBuilder(PlateSheet& sheet) : sheet_(sheet) {}

  void text(double x, double y, std::string words, double height = text_mm) {
    sheet_.texts.push_back({{x, y}, height, std::move(words)});
  }
  void line(cv::Point2d from, cv::Point2d to) { sheet_.lines.push_back({SheetLayer::dimension, {from, to}, false}); }
  void cut(Polygon outline) { sheet_.lines.push_back({SheetLayer::cut, std::move(outline), true}); }
  void box(double x, double y, double width, double height) {
    sheet_.lines.push_back(
        {SheetLayer::dimension, {{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}}, true});
  }
  /// A dimension between two points on a horizontal or vertical line, with arrows and extension lines to the object.
  void dimension(cv::Point2d from, cv::Point2d to, cv::Point2d object, const std::string& words) {
    const bool horizontal = from.y == to.y;
    const cv::Point2d along = (to - from) / cv::norm(to - from);
    const cv::Point2d across(-along.y, along.x);
    line(from, to);
    for (const auto& [end, way] : {std::pair(from, along), std::pair(to, -along)}) {
      for (const double side : {-1.0, 1.0}) line(end, end + 3 * way + side * 0.5 * across);
    }
    const double beyond = 1.5;
    for (const cv::Point2d& end : {from, to}) {
      if (horizontal)
        line({end.x, object.y}, {end.x, end.y + std::copysign(beyond, end.y - object.y)});
      else
        line({object.x, end.y}, {end.x + std::copysign(beyond, end.x - object.x), end.y});
    }
    const cv::Point2d middle = (from + to) / 2;
    const double length = 0.8 * text_mm * static_cast<double>(words.size());
    if (horizontal)
      text(middle.x - length / 2, middle.y - 1, words);
    else
      text(middle.x - length - 1, middle.y + 4, words);
  }

 private:
  PlateSheet& sheet_;
};

std::string mm(double value) {
  return fmt::format("{:.3f}", value == 0 ? 0.0 : value);
}

/// Returns place and height of the number of a cut-out: right of a triangle, in a rectangle, at the end of a bar.
std::pair<cv::Point2d, double> number_place(const CutOutRow& row) {
  if (row.shape == "rectangle") return {row.position_mm + cv::Point2d(2, -2), text_mm};
  if (row.shape != "bar") return {row.position_mm + cv::Point2d(row.side_mm / 2 + 1.5, 1), text_mm};
  const double angle = row.angle_deg * std::numbers::pi / 180;
  constexpr double height = 1.5, beyond = 2.5;
  const double along = row.side_mm / 2 + beyond;
  // The bars of a group are long across the direction of their angle.
  const cv::Point2d end = row.position_mm + along * cv::Point2d(-std::sin(angle), std::cos(angle));
  return {end + cv::Point2d(-height, height / 2), height};
}

/// Draws the plate: outline, cut-outs with their numbers, centre lines, overall dimensions, y of the rows.
void draw_plate(SheetBuilder& to, const TargetPlate& plate, const std::vector<CutOutRow>& rows) {
  const double right = plate.width_mm / 2, bottom = plate.height_mm / 2;
  to.cut({{-right, -bottom}, {right, -bottom}, {right, bottom}, {-right, bottom}});
  to.line({-right - 4, 0}, {right + 4, 0});
  to.line({0, -bottom - 4}, {0, bottom + 4});
  to.dimension({-right, -bottom - 12}, {right, -bottom - 12}, {0, -bottom - 1}, fmt::format("{:g}", plate.width_mm));
  to.dimension({-right - 22, -bottom}, {-right - 22, bottom}, {-right - 1, 0}, fmt::format("{:g}", plate.height_mm));
  std::set<double> heights;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    to.cut(rows[i].outline_mm);
    const auto [at, height] = number_place(rows[i]);
    to.text(at.x, at.y, std::to_string(i + 1), height);
    if (rows[i].shape != "bar") heights.insert(rows[i].position_mm.y);
  }
  for (const double y : heights) {
    to.line({-right - 3, y}, {-right - 1, y});
    to.text(-right - 14, y + 1, fmt::format("{:g}", y));
  }
}

/// Draws the table of cut-outs from (x, y) downwards and returns its end.
double draw_table(SheetBuilder& to, double x, double y, const std::vector<CutOutRow>& rows) {
  constexpr std::array columns{0.0, 10.0, 50.0, 82.0, 98.0, 114.0, 132.0, 150.0};
  const auto write = [&](const std::array<std::string, columns.size()>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) to.text(x + columns[i] + 1, y + row_mm - 1.2, cells[i], 2);
    y += row_mm;
    to.line({x, y}, {x + table_width_mm, y});
  };
  to.line({x, y}, {x + table_width_mm, y});
  write({"no.", "name", "shape", "size", "side", "x", "y", "edges ±"});
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const CutOutRow& row = rows[i];
    const std::string turned = row.angle_deg == 0 ? "" : fmt::format(", {:g}°", row.angle_deg);
    write({std::to_string(i + 1), row.name, row.shape + turned, mm(row.size_mm), mm(row.side_mm), mm(row.position_mm.x),
           mm(row.position_mm.y), fmt::format("{:.4f}", row.edge_tolerance_mm)});
  }
  return y;
}

std::vector<std::string> notes_of(double size_percent) {
  return {"All dimensions in mm, scale 1:1. Origin: centre of the plate, x right, y down, seen from the camera.",
          "Size: square root of the area of a triangle. Triangles are equilateral; x and y are those of the centroid.",
          "Rectangles and bars: size and side are the shorter and the longer side; angles are clockwise.",
          fmt::format("Edges ±: all edges displaced outwards or inwards by this amount change the size by {:g} %.",
                      size_percent),
          "Centroids: ±0.05 to the centre lines. Outline: ±0.2. Corners of cut-outs: radius at most 0.1.",
          "Walls of cut-outs: chamfer from the back, so that the sheet is at most 0.2 thick at the edge.",
          "Camera side: flat to 0.1, matt black, emissivity at least 0.95. Lines of layer CUT only are cut."};
}

/// Draws the title block with its lower right corner at (right, bottom).
void draw_title(SheetBuilder& to, const PlateSheet& sheet, const TargetPlate& plate, std::size_t cut_outs, double right,
                double bottom, std::string_view format) {
  const double width = table_width_mm, height = 4 * 7.0;
  const double x = right - width, y = bottom - height;
  to.box(x, y, width, height);
  for (int i = 1; i < 4; ++i) to.line({x, y + 7.0 * i}, {right, y + 7.0 * i});
  to.line({x + width / 2, y + 7}, {x + width / 2, bottom});
  to.text(x + 2, y + 5, "Target plate " + sheet.title, 3.5);
  to.text(x + 2, y + 12, fmt::format("Plate {:g} x {:g} mm, {} cut-outs", plate.width_mm, plate.height_mm, cut_outs));
  to.text(x + width / 2 + 2, y + 12, fmt::format("Scale 1:1, sheet {}", format));
  to.text(x + 2, y + 19, "Material, thickness:");
  to.text(x + width / 2 + 2, y + 19, "Finish: matt black");
  to.text(x + 2, y + 26, "Made by, date:");
  to.text(x + width / 2 + 2, y + 26, "Inspected by, date:");
}

}  // namespace

std::string_view to_string(SheetLayer layer) {
  constexpr std::array<std::string_view, 3> names{"CUT", "DIMENSION", "TEXT"};
  return names[static_cast<std::size_t>(layer)];
}

std::vector<CutOutRow> cut_out_rows(const TargetPlate& plate, double size_percent) {
  std::vector<CutOutRow> rows;
  for (const PlateTriangle& t : plate.triangles) {
    rows.push_back({.name = t.name,
                    .shape = "triangle, apex " + std::string(to_string(t.apex)),
                    .position_mm = t.position_mm,
                    .size_mm = t.size_mm,
                    .side_mm = triangle_side * t.size_mm,
                    .angle_deg = 0,
                    .edge_tolerance_mm = size_percent / 100 * triangle_centroid_to_base * t.size_mm,
                    .outline_mm = triangle(t.size_mm, t.apex, t.position_mm)});
  }
  const std::size_t plain = plate.rectangles.size();
  const auto straight = straight_cut_outs(plate);
  for (std::size_t i = 0; i < straight.size(); ++i) {
    const PlateRectangle& r = straight[i];
    const double shorter = std::min(r.size_mm.width, r.size_mm.height);
    rows.push_back({.name = r.name,
                    .shape = i < plain ? "rectangle" : "bar",
                    .position_mm = r.position_mm,
                    .size_mm = shorter,
                    .side_mm = std::max(r.size_mm.width, r.size_mm.height),
                    .angle_deg = r.angle_deg,
                    .edge_tolerance_mm = size_percent / 100 * shorter / 2,
                    .outline_mm = outline_mm(r)});
  }
  return rows;
}

SizeErrors size_errors(const PlateTriangle& triangle, const MakingErrors& errors) {
  const double size = triangle.size_mm;
  // A corner of 60 degrees rounded with r loses r^2 (sqrt(3) - pi / 3); size is the root of the area.
  const double lost = 3 * (std::numbers::sqrt3 - std::numbers::pi / 3) * std::pow(errors.corner_radius_mm / size, 2);
  // Through the sheet one sees the intersection of the outline with itself, shifted by v towards the centre. It is
  // similar: its height, 3 times the distance of the centroid from an edge, loses the parts of v against the normals.
  const cv::Point2d v = -triangle.position_mm * (errors.thickness_mm / (1000 * errors.distance_m));
  const Polygon outline = todbench::triangle(size, triangle.apex);
  double hidden_mm = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const cv::Point2d middle = (outline[i] + outline[(i + 1) % outline.size()]) / 2;  // along the outward normal
    hidden_mm += std::max(0.0, -v.dot(middle) / cv::norm(middle));
  }
  return {.edges_percent = 100 * errors.edge_mm / (triangle_centroid_to_base * size),
          .corners_percent = -100 * (1 - std::sqrt(1 - std::min(1.0, lost))),
          .sheet_percent = -100 * std::min(1.0, hidden_mm / (triangle_height * size))};
}

Result<PlateSheet> plate_sheet(const TargetPlate& plate, double size_percent) {
  const std::vector<CutOutRow> rows = cut_out_rows(plate, size_percent);
  if (rows.empty()) return fail(ErrorCode::invalid_input, "plate \"" + plate.name + "\" has no cut-outs to draw");
  const auto notes = notes_of(size_percent);
  const double table_mm = row_mm * static_cast<double>(rows.size() + 1 + notes.size()) + 28 + 20;
  const double width = frame_mm + margin_left_mm + plate.width_mm + table_gap_mm + table_width_mm + frame_mm + 5;
  const double height = 2 * frame_mm + std::max(margin_top_mm + plate.height_mm + margin_bottom_mm, table_mm);
  PaperFormat paper{"of its own size", width, height};
  for (const PaperFormat& format : paper_formats) {
    if (format.width_mm < width || format.height_mm < height) continue;
    paper = format;
    break;
  }
  PlateSheet sheet{.title = plate.name,
                   .left_mm = -plate.width_mm / 2 - margin_left_mm - frame_mm,
                   .top_mm = -plate.height_mm / 2 - margin_top_mm - frame_mm,
                   .width_mm = paper.width_mm,
                   .height_mm = paper.height_mm,
                   .lines = {},
                   .texts = {}};
  SheetBuilder to(sheet);
  const double right = sheet.left_mm + paper.width_mm - frame_mm, bottom = sheet.top_mm + paper.height_mm - frame_mm;
  to.box(sheet.left_mm + frame_mm, sheet.top_mm + frame_mm, paper.width_mm - 2 * frame_mm,
         paper.height_mm - 2 * frame_mm);
  draw_plate(to, plate, rows);
  double y = draw_table(to, right - table_width_mm - 5, sheet.top_mm + frame_mm + 5, rows) + 3;
  for (const std::string& note : notes) to.text(right - table_width_mm - 5, y += row_mm, note, 2);
  draw_title(to, sheet, plate, rows.size(), right, bottom, paper.name);
  return sheet;
}

}  // namespace todbench
