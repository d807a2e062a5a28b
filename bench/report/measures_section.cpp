// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/measures_section.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "bench/report/ctf_figures.h"
#include "bench/report/drawing.h"
#include "bench/report/drift_figures.h"
#include "bench/report/geometry_figure.h"
#include "bench/report/number_format.h"
#include "bench/report/pixel_figures.h"
#include "bench/report/plot.h"
#include "bench/report/report_pieces.h"
#include "bench/report/response_figure.h"
#include "bench/report/transfer_figures.h"

namespace todbench {
namespace {

constexpr std::array<std::pair<std::string_view, std::string_view>, 53> names{{
    {"scene_ratio", "Response to triangles with a hot bar in the field, over the response without it"},
    {"transfer_slope", "Temperature scale (SiTF slope): observed over shown contrast"},
    {"transfer_offset", "Temperature scale (SiTF): offset"},
    {"transfer_nonlinearity", "Temperature scale (SiTF): nonlinearity"},
    {"ifov_x", "IFOV along x, from the positions of the triangles"},
    {"ifov_y", "IFOV along y, from the positions of the triangles"},
    {"ifov_stated", "IFOV stated in the plan"},
    {"ifov_model", "IFOV of the sensor model"},
    {"plate_rotation", "Rotation of the plate in the picture, clockwise"},
    {"keystone_x", "Keystone: scale at the right border of the plate over scale at the left border, minus 1"},
    {"keystone_y", "Keystone: scale at the lower border of the plate over scale at the upper border, minus 1"},
    {"distortion", "Radial distortion at the corner of the picture"},
    {"distortion_model", "Radial distortion at the corner of the picture, sensor model"},
    {"geometry_residual", "Positions of the triangles: residual after the lens fit"},
    {"temporal_noise", "Temporal noise of a pixel"},
    {"netd", "NETD (temporal noise over the temperature scale)"},
    {"netd_model", "NETD, closed form of the sensor model"},
    {"lag1_correlation", "Correlation of a pixel in successive frames"},
    {"noise_counts", "Temporal noise in quantization steps"},
    {"shading_range", "Shading over the plate, removed"},
    {"drift_rate", "Drift of the mean after a correction"},
    {"drift_time_constant", "Drift of the mean: time constant"},
    {"drift_pattern_rate", "Growth of the spatial noise after a correction"},
    {"drift_pattern_time_constant", "Growth of the spatial noise: time constant"},
    {"response_time", "Response time: time constant of the step response"},
    {"response_time_rise", "Response time of rising steps"},
    {"response_time_fall", "Response time of falling steps"},
    {"response_time_model", "Response time of the sensor model"},
    {"noise_t", "3-D noise t: whole frames"},
    {"noise_v", "3-D noise v: fixed rows"},
    {"noise_h", "3-D noise h: fixed columns"},
    {"noise_tv", "3-D noise tv: rows in time"},
    {"noise_th", "3-D noise th: columns in time"},
    {"noise_vh", "3-D noise vh: fixed pattern"},
    {"noise_tvh", "3-D noise tvh: pixels in time"},
    {"picture_residual", "Picture of the plate against the sensor model: residual"},
    {"picture_residual_over_noise", "Picture of the plate: residual over the temporal noise of the mean"},
    {"mtf_x", "MTF along x at the frequency of the plan"},
    {"mtf50_x", "Frequency of MTF 0.5 along x"},
    {"mtf_x_model", "MTF along x, closed form of the sensor model"},
    {"mtf_y", "MTF along y at the frequency of the plan"},
    {"mtf50_y", "Frequency of MTF 0.5 along y"},
    {"mtf_y_model", "MTF along y, closed form of the sensor model"},
    {"ctf_x", "CTF of four bars along x, best sampling phase"},
    {"ctf_mean_x", "CTF along x, mean of the sampling phases"},
    {"ctf_worst_x", "CTF along x, worst sampling phase"},
    {"ctf_x_model", "CTF along x, best phase, closed form of the sensor model"},
    {"ctf_worst_x_model", "CTF along x, worst phase, closed form of the sensor model"},
    {"ctf_y", "CTF of four bars along y, best sampling phase"},
    {"ctf_mean_y", "CTF along y, mean of the sampling phases"},
    {"ctf_worst_y", "CTF along y, worst sampling phase"},
    {"ctf_y_model", "CTF along y, best phase, closed form of the sensor model"},
    {"ctf_worst_y_model", "CTF along y, worst phase, closed form of the sensor model"},
}};

std::string name_of(const MeasureLine& line) {
  if (const std::string name = pixel_measure_name(line.measure); !name.empty())
    return name + (line.unit == "1" ? "" : " (" + line.unit + ")");
  // "mtf_x (NAME)"
  const std::string measure = line.measure.substr(0, line.measure.find(" ("));
  const auto found = std::find_if(names.begin(), names.end(), [&](const auto& row) { return row.first == measure; });
  return (found == names.end() ? line.measure : std::string(found->second) + line.measure.substr(measure.size())) +
         (line.unit == "1" ? "" : " (" + line.unit + ")");
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

PlotSeries mtf_series(const EdgeMtf& edge, double pitch_mrad, std::string label, PlotTone tone, PlotLine line) {
  PlotSeries series{.label = std::move(label), .tone = tone, .marker = PlotMarker::none, .line = line, .points = {}};
  constexpr std::size_t every = 2;  // of 101 frequencies
  for (std::size_t i = 0; i < edge.mtf.size(); i += every) {
    series.points.push_back({.x = edge.frequency_per_pitch[i] / pitch_mrad,
                             .y = std::max(0.0, edge.mtf[i]),
                             .x_interval = {},
                             .y_interval = {}});
  }
  return series;
}

/// Returns the intervals at every tenth of a cycle.
PlotSeries mtf_bars(const EdgeMtf& edge, double pitch_mrad, PlotTone tone, PlotMarker marker) {
  PlotSeries series{.label = "", .tone = tone, .marker = marker, .points = {}};
  constexpr std::size_t every = 10;
  for (std::size_t i = every; i < edge.mtf.size(); i += every) {
    series.points.push_back({.x = edge.frequency_per_pitch[i] / pitch_mrad,
                             .y = std::max(0.0, edge.mtf[i]),
                             .x_interval = {},
                             .y_interval = {std::max(0.0, edge.low[i]), std::max(0.0, edge.high[i])}});
  }
  return series;
}

const EdgeMtf* edge_of(const std::optional<MeasureLines>& side, const EdgeMtf& like) {
  if (!side || !side->mtf) return nullptr;
  for (const EdgeMtf& edge : side->mtf->edges)
    if (edge.place == like.place && edge.axis == like.axis) return &edge;
  return nullptr;
}

/// Returns the figure of one place and axis: camera with intervals, twin, closed form.
Figure mtf_figure(const EdgeMtf& edge, const SessionMeasures& measures, bool camera) {
  Plot plot;
  const std::string axis(to_string(edge.axis));
  plot.id = "mtf-" + axis;
  for (const char c : edge.place) plot.id += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '-';
  plot.title = "MTF along " + axis + ", " + edge.place;
  plot.description = "Modulation transfer over spatial frequency with 95 % intervals";
  plot.width = 430, plot.height = 350;
  double highest = 1.1, beyond_pitch_mrad = 0;
  const std::optional<MeasureLines>* const sides[] = {&measures.twin, &measures.main};
  for (const auto* side : sides) {
    const EdgeMtf* found = edge_of(*side, edge);
    if (found == nullptr) continue;
    const bool first = side == &measures.main;
    const double pitch_mrad = (*side)->mtf->pitch_mrad;
    if (!found->model.empty()) {
      EdgeMtf model = *found;
      model.mtf = model.model;
      plot.series.push_back(mtf_series(model, pitch_mrad, "closed form", PlotTone::muted, PlotLine::dotted));
    }
    const PlotTone tone = first ? PlotTone::first : PlotTone::second;
    const std::string label = first ? (camera ? "camera" : "simulated sensor") : "simulated twin";
    plot.series.push_back(mtf_series(*found, pitch_mrad, label, tone, first ? PlotLine::solid : PlotLine::dashed));
    if (first) plot.series.push_back(mtf_bars(*found, pitch_mrad, tone, PlotMarker::disc));
    for (const double value : found->mtf) highest = std::max(highest, value);
    plot.x.high = 1 / pitch_mrad;
    beyond_pitch_mrad = pitch_mrad;
  }
  plot.x.label = "Frequency (1/mrad)";
  if (beyond_pitch_mrad > 0)
    plot.bands.push_back({"beyond half a cycle per pixel", PlotTone::muted, {0.5 / beyond_pitch_mrad, std::nullopt}});
  plot.y = {.label = "MTF along " + axis, .low = 0, .high = highest, .ticks = {}};
  return {drawn(plot), "MTF along " + axis + " at '" + edge.place + "', up to one cycle per pixel pitch"};
}

std::optional<FigurePairs> mtf_figures(const SessionMeasures& measures, bool camera) {
  const auto& side = measures.main ? measures.main : measures.twin;
  if (!side || !side->mtf) return std::nullopt;
  FigurePairs figures;
  for (const EdgeMtf& edge : side->mtf->edges) figures.figures.push_back(mtf_figure(edge, measures, camera));
  return figures;
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
  if (auto figures = transfer_figures(*data.measures, data.camera.has_value()))
    section.blocks.emplace_back(*std::move(figures));
  if (auto figures = mtf_figures(*data.measures, data.camera.has_value()))
    section.blocks.emplace_back(*std::move(figures));
  if (auto figures = drift_figures(*data.measures)) section.blocks.emplace_back(*std::move(figures));
  if (auto figures = response_figure(*data.measures, data.camera.has_value()))
    section.blocks.emplace_back(*std::move(figures));
  if (auto figures = geometry_figures(*data.measures, data.camera.has_value()))
    section.blocks.emplace_back(*std::move(figures));
  if (auto figures = ctf_figures(*data.measures, data.camera.has_value()))
    section.blocks.emplace_back(*std::move(figures));
  if (main && main->picture) section.blocks.emplace_back(plate_figures(*main->picture, twin, data.camera.has_value()));
  if (auto figures = pixel_figures(*data.measures, data.camera.has_value()))
    section.blocks.emplace_back(*std::move(figures));
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
