// SPDX-License-Identifier: GPL-3.0-or-later
// todbench plate
#include "bench/cli/commands.h"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <memory>

#include "bench/plan/descriptions.h"
#include "bench/plate_drawing/sheet_files.h"
#include "bench/text/files.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

struct PlateArguments {
  std::string plate, svg, dxf, pdf;
  double size_percent = 1;
  MakingErrors errors{};
};

Json cut_outs_json(const std::vector<CutOutRow>& rows) {
  Json cut_outs = Json::array();
  for (const CutOutRow& row : rows) {
    Json outline = Json::array();
    for (const cv::Point2d& p : row.outline_mm) outline.push_back(Json{p.x, p.y});
    cut_outs.push_back({{"name", row.name},
                        {"shape", row.shape},
                        {"size_mm", row.size_mm},
                        {"side_mm", row.side_mm},
                        {"x_mm", row.position_mm.x},
                        {"y_mm", row.position_mm.y},
                        {"angle_deg", row.angle_deg},
                        {"edge_tolerance_mm", row.edge_tolerance_mm},
                        {"outline_mm", std::move(outline)}});
  }
  return cut_outs;
}

/// The triangle of each size that is farthest from the centre, where the thickness of the sheet matters most.
std::map<double, PlateTriangle> farthest_of_each_size(const TargetPlate& plate) {
  std::map<double, PlateTriangle> farthest;
  for (const PlateTriangle& t : plate.triangles) {
    const auto [at, added] = farthest.try_emplace(t.size_mm, t);
    if (cv::norm(t.position_mm) > cv::norm(at->second.position_mm)) at->second = t;
  }
  return farthest;
}

Json errors_json(const TargetPlate& plate, const MakingErrors& errors) {
  Json list = Json::array();
  for (const auto& [size_mm, t] : farthest_of_each_size(plate)) {
    const SizeErrors found = size_errors(t, errors);
    list.push_back({{"size_mm", size_mm},
                    {"edges_percent", found.edges_percent},
                    {"corners_percent", found.corners_percent},
                    {"sheet_percent", found.sheet_percent}});
  }
  return list;
}

void print_errors(Console& console, const TargetPlate& plate, const PlateArguments& a) {
  std::vector<TableRow> rows;
  for (const auto& [size_mm, t] : farthest_of_each_size(plate)) {
    const SizeErrors found = size_errors(t, a.errors);
    rows.push_back({fixed(size_mm, 3), fixed(a.size_percent / 100 * triangle_centroid_to_base * size_mm, 4),
                    fixed(found.edges_percent, 2), fixed(found.corners_percent, 2), fixed(found.sheet_percent, 2)});
  }
  if (rows.empty()) return;
  console.table({"size [mm]", fmt::format("edges for {:g} % [mm]", a.size_percent),
                 fmt::format("edges {:g} mm out [%]", a.errors.edge_mm),
                 fmt::format("corners of radius {:g} mm [%]", a.errors.corner_radius_mm),
                 fmt::format("sheet of {:g} mm at {:g} m [%]", a.errors.thickness_mm, a.errors.distance_m)},
                rows);
  console.text("An error of 1 % in all sizes changes the acuity by 1 %.");
}

int run_plate(Console& console, const PlateArguments& a) {
  const auto plate = load_plate(a.plate);
  if (!plate) return report_error(console, plate.error());
  const auto sheet = plate_sheet(*plate, a.size_percent);
  if (!sheet) return report_error(console, sheet.error());
  Json files = Json::array();
  using Writer = std::string (*)(const PlateSheet&);
  for (const auto& [file, write] : {std::pair<const std::string&, Writer>(a.svg, sheet_svg),
                                    std::pair<const std::string&, Writer>(a.dxf, sheet_dxf),
                                    std::pair<const std::string&, Writer>(a.pdf, sheet_pdf)}) {
    if (file.empty()) continue;
    if (auto written = write_file_atomically(file, write(*sheet)); !written)
      return report_error(console, written.error());
    files.push_back(file);
    console.text("drawing: " + file);
  }
  if (console.json()) {
    console.object({{"name", plate->name},
                    {"width_mm", plate->width_mm},
                    {"height_mm", plate->height_mm},
                    {"size_tolerance_percent", a.size_percent},
                    {"cut_outs", cut_outs_json(cut_out_rows(*plate, a.size_percent))},
                    {"size_errors", errors_json(*plate, a.errors)},
                    {"files", std::move(files)}});
    return 0;
  }
  print_errors(console, *plate, a);
  return 0;
}

}  // namespace

void add_plate_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand(
      "plate", "draws a plate for the workshop, with dimensions in mm, and states the cost of errors in acuity");
  auto a = std::make_shared<PlateArguments>();
  command->add_option("PLATE", a->plate, "plate: name or file")->required();
  command->add_option("--svg", a->svg, "file of the drawing as SVG");
  command->add_option("--dxf", a->dxf, "file of the drawing as DXF (release 12), for cutting machines");
  command->add_option("--pdf", a->pdf, "file of the drawing as PDF, scale 1:1");
  command->add_option("--size-percent", a->size_percent, "permitted error of a size, for the tolerances of the edges")
      ->check(number_in(0.01, 20))
      ->capture_default_str();
  command->add_option("--edge-mm", a->errors.edge_mm, "displacement of all edges, for the table of errors")
      ->check(number_in(-1, 1, "mm"))
      ->capture_default_str();
  command->add_option("--corner-radius-mm", a->errors.corner_radius_mm, "radius of the corners, for the same table")
      ->check(number_in(0, 10, "mm"))
      ->capture_default_str();
  command->add_option("--thickness-mm", a->errors.thickness_mm, "thickness of the sheet, for the same table")
      ->check(number_in(0, 50, "mm"))
      ->capture_default_str();
  command->add_option("--distance-m", a->errors.distance_m, "distance of the plate, for the same table")
      ->check(number_in(0.05, 1000, "m"))
      ->capture_default_str();
  finish_command(*command, program, [a](Console& console) { return run_plate(console, *a); });
}

}  // namespace todbench
