// SPDX-License-Identifier: GPL-3.0-or-later
// The drawing of a plate: its files are parsed again and compared with the geometry of the plate.
#include "bench/plate_drawing/plate_drawing.h"

#include <gmock/gmock.h>

#include <opencv2/imgproc.hpp>
#include <regex>
#include <sstream>

#include "bench/plan/descriptions.h"
#include "bench/plate_drawing/sheet_files.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;

constexpr double file_tolerance_mm = 1e-6;

/// The outlines that a workshop has to cut: the plate, then its cut-outs.
std::vector<Polygon> expected_outlines(const TargetPlate& plate) {
  const double x = plate.width_mm / 2, y = plate.height_mm / 2;
  std::vector<Polygon> outlines{{{-x, -y}, {x, -y}, {x, y}, {-x, y}}};
  for (const PlateTriangle& t : plate.triangles) outlines.push_back(triangle(t.size_mm, t.apex, t.position_mm));
  for (const PlateRectangle& r : straight_cut_outs(plate)) outlines.push_back(outline_mm(r));
  return outlines;
}

/// Reads the polygons of the layer CUT of an SVG file.
std::vector<Polygon> svg_outlines(const std::string& svg) {
  const std::size_t begin = svg.find("<g id=\"CUT\"");
  const std::string layer = svg.substr(begin, svg.find("</g>", begin) - begin);
  std::vector<Polygon> outlines;
  const std::regex polygon("<polygon points=\"([^\"]*)\"");
  for (std::sregex_iterator it(layer.begin(), layer.end(), polygon), end; it != end; ++it) {
    std::istringstream points((*it)[1].str());
    Polygon outline;
    char comma = 0;
    for (cv::Point2d p; points >> p.x >> comma >> p.y;) outline.push_back(p);
    outlines.push_back(outline);
  }
  return outlines;
}

/// Reads the closed polylines of the layer CUT of a DXF file; y is up there.
std::vector<Polygon> dxf_outlines(const std::string& dxf) {
  std::istringstream lines(dxf);
  std::vector<Polygon> outlines;
  std::string entity, layer, code, value;
  cv::Point2d at;
  const auto finish = [&] {
    if (layer == "CUT" && entity == "POLYLINE") outlines.emplace_back();
    if (layer == "CUT" && entity == "VERTEX") outlines.back().push_back(at);
  };
  while (std::getline(lines, code) && std::getline(lines, value)) {
    const int group = std::stoi(code);
    if (group == 0) {
      finish();
      entity = value;
      layer.clear();
    } else if (group == 8) {
      layer = value;
    } else if (group == 10) {
      at.x = std::stod(value);
    } else if (group == 20) {
      at.y = -std::stod(value);
    }
  }
  EXPECT_EQ(value, "EOF");
  return outlines;
}

void expect_equal_outlines(const std::vector<Polygon>& found, const std::vector<Polygon>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    ASSERT_EQ(found[i].size(), expected[i].size()) << i;
    for (std::size_t k = 0; k < found[i].size(); ++k)
      EXPECT_LT(cv::norm(found[i][k] - expected[i][k]), file_tolerance_mm) << i << ", " << k;
  }
}

class DrawingOfAPlate : public ::testing::TestWithParam<const char*> {
 protected:
  TargetPlate plate_ = load_plate(GetParam()).value();
  PlateSheet sheet_ = plate_sheet(plate_, 1).value();
};
INSTANTIATE_TEST_SUITE_P(Shipped, DrawingOfAPlate, ::testing::Values("tcat-a", "tcat-b", "edge", "bars"));

TEST_P(DrawingOfAPlate, HasInItsSvgTheVerticesOfThePlate) {
  expect_equal_outlines(svg_outlines(sheet_svg(sheet_)), expected_outlines(plate_));
}

TEST_P(DrawingOfAPlate, HasInItsDxfTheVerticesOfThePlate) {
  expect_equal_outlines(dxf_outlines(sheet_dxf(sheet_)), expected_outlines(plate_));
}

TEST_P(DrawingOfAPlate, HasInItsPdfALineForEachOfItsLinesAndAValidTableOfObjects) {
  const std::string pdf = sheet_pdf(sheet_);

  const auto count = [&](const std::string& word) {
    std::size_t found = 0;
    for (std::size_t at = pdf.find(word); at != std::string::npos; at = pdf.find(word, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count(" m\n"), sheet_.lines.size());
  EXPECT_EQ(count(") Tj ET\n"), sheet_.texts.size());
  // Every entry of the table points to its object.
  std::istringstream table(pdf.substr(pdf.rfind("\nxref\n") + 6));
  std::string line;
  std::getline(table, line);
  std::getline(table, line);
  for (int object = 1; object <= 5; ++object) {
    std::getline(table, line);
    EXPECT_EQ(pdf.compare(std::stoul(line), 7, std::to_string(object) + " 0 obj"), 0) << line;
  }
  EXPECT_EQ(std::stoul(pdf.substr(pdf.rfind("startxref\n") + 10)), pdf.rfind("\nxref\n") + 1);
}

TEST_P(DrawingOfAPlate, KeepsEverythingOnItsSheet) {
  const cv::Rect2d paper(sheet_.left_mm, sheet_.top_mm, sheet_.width_mm, sheet_.height_mm);
  for (const SheetLine& line : sheet_.lines) {
    for (const cv::Point2d& p : line.points_mm) EXPECT_TRUE(paper.contains(p)) << p;
  }
  // A capital of Helvetica is 0.72 of its font; a character is 0.6 of the font wide at most on average.
  for (const SheetText& text : sheet_.texts) {
    const double end_mm = text.at_mm.x + 0.6 * text.height_mm / 0.72 * static_cast<double>(text.text.size());
    EXPECT_TRUE(paper.contains(text.at_mm) && end_mm < paper.br().x) << text.text;
  }
}

TEST(SizeErrors, OfDisplacedEdgesAreThoseOfTheLargerTriangle) {
  const PlateTriangle t{.name = "t", .position_mm = {0, 0}, .size_mm = 3, .apex = Apex::up};
  const double edge_mm = 0.05;

  const double found = size_errors(t, {.edge_mm = edge_mm}).edges_percent;

  // The centroid is (size x 0.43869) from every edge; a triangle with that distance grown by the displacement.
  const double inradius_mm = triangle_centroid_to_base * t.size_mm;
  EXPECT_NEAR(found, 100 * ((inradius_mm + edge_mm) / inradius_mm - 1), 1e-12);
}

TEST(SizeErrors, OfRoundedCornersAreThoseOfTheArea) {
  const PlateTriangle t{.name = "t", .position_mm = {0, 0}, .size_mm = 3, .apex = Apex::left};
  const double radius_mm = 0.4;

  const double found = size_errors(t, {.corner_radius_mm = radius_mm}).corners_percent;

  // Area by Steiner's formula: the triangle with inradius less r, dilated by a disc of radius r.
  const double shrunk = 1 - radius_mm / (triangle_centroid_to_base * t.size_mm);
  const double core = shrunk * shrunk * t.size_mm * t.size_mm;
  const double area =
      core + 3 * triangle_side * t.size_mm * shrunk * radius_mm + std::numbers::pi * radius_mm * radius_mm;
  EXPECT_NEAR(found, 100 * (std::sqrt(area) / t.size_mm - 1), 1e-9);
}

TEST(SizeErrors, OfAThickSheetAreThoseOfTheVisibleIntersection) {
  for (const Apex apex : all_apexes) {
    const PlateTriangle t{.name = "t", .position_mm = {71.5, -112}, .size_mm = 3, .apex = apex};
    const MakingErrors errors{.thickness_mm = 4, .distance_m = 1.5};

    const double found = size_errors(t, errors).sheet_percent;

    const cv::Point2d shift = -t.position_mm * (errors.thickness_mm / (1000 * errors.distance_m));
    std::vector<cv::Point2f> front, back, both;
    for (const cv::Point2d& p : triangle(t.size_mm, apex)) {
      front.emplace_back(p);
      back.emplace_back(p + shift);
    }
    const double area = cv::intersectConvexConvex(front, back, both);
    // 32-bit vertices of 3 mm: 1e-6 of the area.
    EXPECT_NEAR(found, 100 * (std::sqrt(area) / t.size_mm - 1), 1e-3) << to_string(apex);
    EXPECT_LT(found, -1);
  }
}

TEST(PlateSheet, OfAPlateWithoutCutOutsIsRefused) {
  const TargetPlate plate{.name = "blank", .description = "", .width_mm = 10, .height_mm = 10, .triangles = {}};

  const auto sheet = plate_sheet(plate, 1);

  ASSERT_FALSE(sheet);
  EXPECT_THAT(sheet.error().message, HasSubstr("no cut-outs"));
}

}  // namespace
}  // namespace todbench
