// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/measures_section.h"

#include <algorithm>
#include <utility>

#include "bench/plan/quantity.h"
#include "bench/report/drawing.h"
#include "bench/report/measure_figures.h"
#include "bench/report/number_format.h"
#include "bench/report/report_pieces.h"

namespace todbench {
namespace {

/// Returns "Bad pixels in zone 'centre'" for "bad_pixels (centre)", "MTF along x (corner)" for "mtf_x (corner)".
std::string name_of(const MeasureLine& line) {
  const std::string unit = line.unit == "1" ? "" : " (" + line.unit + ")";
  const Quantity* quantity = find_quantity(line.measure);
  if (quantity == nullptr) return line.measure + unit;
  std::string place = line.measure.substr(quantity->name.size());
  if (quantity->measure == "pixels" && !place.empty()) place = " in zone '" + place.substr(2, place.size() - 3) + "'";
  return std::string(quantity->title) + place + unit;
}

RichText value_of(const MeasureLine* line) {
  if (line == nullptr) return missing("not measured");
  if (!line->value) return missing("not known");
  if (line->ci95.low == line->value && line->ci95.high == line->value) return plain(stated(*line->value));
  if (!line->ci95.low && !line->ci95.high) return plain(significant(*line->value, 3));
  RichText text = interval_or_missing(line->value, line->ci95, "not measured");
  if (line->expanded) text += plain("; expanded ") + interval_or_missing(line->value, *line->expanded, "");
  return text;
}

const MeasureLine* line_of(const std::optional<MeasureLines>& side, std::string_view measure) {
  if (!side) return nullptr;
  const auto found = std::find_if(side->lines.begin(), side->lines.end(),
                                  [&](const MeasureLine& line) { return line.measure == measure; });
  return found == side->lines.end() ? nullptr : &*found;
}

/// Returns one panel, with outlines if given.
Figure panel_figure(const PlatePanels& panels, const std::string& png, const std::string& id, const std::string& title,
                    const std::string& caption, bool outlined) {
  constexpr double width = 430;
  const double scale = width / panels.width;
  Drawing drawing;
  drawing.id = "plate-" + id, drawing.title = title, drawing.description = caption;
  drawing.width = width;
  drawing.height = scale * panels.height;
  drawing.frame = {0, 0, drawing.width, drawing.height};
  drawing.inside.push_back({.shape = Raster{drawing.frame, png}});
  if (outlined) {
    Polyline line;
    for (const Polygon& outline : panels.outlines) {
      std::vector<Place> run;
      for (std::size_t i = 0; i <= outline.size() && !outline.empty(); ++i) {
        const cv::Point2d& p = outline[i % outline.size()];
        run.push_back({(p.x + 0.5) * scale, (p.y + 0.5) * scale});
      }
      line.runs.push_back(std::move(run));
    }
    drawing.inside.push_back({.shape = std::move(line), .pen = Pen::curve, .tone = PlotTone::second});
  }
  return {std::move(drawing), caption};
}

/// Returns the plate of the camera with the detected shapes, that of the sensor model, and the difference; also the
/// difference of the twin, which shows the effect of noise alone.
FigurePairs plate_figures(const PlatePanels& panels, const std::optional<MeasureLines>& twin, bool camera) {
  const std::string who = camera ? "camera" : "simulated sensor";
  const auto kelvin = [](double value) { return significant(value, 3) + " K"; };
  const std::string range = kelvin(panels.black_k) + " black to " + kelvin(panels.white_k) + " white";
  FigurePairs figures;
  figures.figures.push_back(
      panel_figure(panels, panels.seen, "seen", "Plate observed by the " + who,
                   "Plate observed by the " + who + ", " + range + "; outlines: triangles as located", true));
  figures.figures.push_back(
      panel_figure(panels, panels.expected, "expected", "Plate computed by the sensor model",
                   "Plate computed by the sensor model at the same position, without noise, " + range, false));
  const auto difference = [&](const PlatePanels& of, const std::string& id, const std::string& name) {
    figures.figures.push_back(panel_figure(
        of, of.difference, id, "Difference, " + name,
        "Difference, " + name + ": black −" + kelvin(of.difference_k) + ", white +" + kelvin(of.difference_k), false));
  };
  difference(panels, "difference", who + " minus sensor model");
  if (twin && twin->picture)
    difference(*twin->picture, "difference-twin", "simulated twin minus sensor model (effect of noise alone)");
  return figures;
}

}  // namespace

std::optional<Section> measures_section(const ReportData& data) {
  if (!data.measures || (!data.measures->main && !data.measures->twin)) return std::nullopt;
  const auto& main = data.measures->main;
  const auto& twin = data.measures->twin;
  Section section{"Physical measures", {}};
  Table table{.caption = "", .header = {"Measure", data.camera ? "camera" : "simulated sensor"}, .rows = {}};
  if (twin) table.header.emplace_back("simulated twin");
  table.header.emplace_back("Conditions");
  std::vector<std::string> conditions;  // the rows refer to a condition by its number
  std::vector<MeasureLine> lines = (main ? main : twin)->lines;
  // Measures of the twin alone, for example its closed form.
  if (main && twin) {
    for (const MeasureLine& line : twin->lines)
      if (line_of(main, line.measure) == nullptr) lines.push_back(line);
  }
  for (const MeasureLine& line : lines) {
    const MeasureLine* of_main = line_of(main, line.measure);
    // A camera has no closed form, so the value is not missing.
    const bool closed_form = of_main == nullptr && line.measure.ends_with("_model");
    std::vector<RichText> row{plain(name_of(line)), closed_form ? plain("–") : value_of(of_main)};
    if (twin) row.push_back(value_of(line_of(twin, line.measure)));
    const auto known = std::find(conditions.begin(), conditions.end(), line.conditions);
    row.push_back(plain(std::to_string(known - conditions.begin() + 1)));
    if (known == conditions.end()) conditions.push_back(line.conditions);
    table.rows.push_back(std::move(row));
  }
  for (std::size_t i = 0; i < conditions.size(); ++i) conditions[i].insert(0, std::to_string(i + 1) + ": ");
  if (!table.rows.empty()) section.blocks.emplace_back(std::move(table));
  if (!conditions.empty()) section.blocks.emplace_back(list_of(conditions));
  const bool camera = data.camera.has_value();
  for (const auto& figures_of :
       {transfer_figures, mtf_figures, drift_figures, response_figures, geometry_figures, ctf_figures,
        source_size_figures, absolute_figures, latency_figures, gain_control_figures}) {
    if (auto figures = figures_of(*data.measures, camera)) section.blocks.emplace_back(*std::move(figures));
  }
  if (main && main->picture) section.blocks.emplace_back(plate_figures(*main->picture, twin, camera));
  if (auto figures = pixel_figures(*data.measures, camera)) section.blocks.emplace_back(*std::move(figures));
  std::vector<std::string> reasons;
  if (main) reasons = main->reasons;
  if (twin) {
    for (const auto& reason : twin->reasons) reasons.push_back("Simulated twin: " + reason);
  }
  if (!reasons.empty()) section.blocks.emplace_back(list_of(reasons));
  section.blocks.emplace_back(
      note(plain("Brackets: 95 % intervals for the finite number of frames, pixels and steps. They do not include the "
                 "uncertainty of the black body, the air path and the emissivity.")));
  return section;
}

}  // namespace todbench
