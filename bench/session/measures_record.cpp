// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/measures_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "acquisition/base/normal.h"
#include "acquisition/base/try.h"
#include "bench/plan/quantity.h"
#include "bench/session/measure_row.h"
#include "bench/text/base64.h"
#include "bench/text/json_reader.h"

namespace todbench {
namespace {

PlatePanels panels_of(const PlatePicture& picture) {
  const cv::Mat1d& seen = picture.seen.kelvin;
  PlatePanels panels;
  panels.width = seen.cols, panels.height = seen.rows;
  cv::minMaxLoc(picture.expected_k, &panels.black_k, &panels.white_k);
  constexpr double shown = 4;  // standard deviations of the residual on either side
  panels.difference_k = std::max(shown * picture.residual_k, 1e-9);
  panels.seen = grey_png(seen, panels.black_k, panels.white_k);
  panels.expected = grey_png(picture.expected_k, panels.black_k, panels.white_k);
  panels.difference = grey_png(seen - picture.expected_k, -panels.difference_k, panels.difference_k);
  for (Polygon outline : picture.outlines) {
    for (cv::Point2d& p : outline) p -= cv::Point2d(picture.seen.field.tl());
    panels.outlines.push_back(std::move(outline));
  }
  return panels;
}

void add_picture(MeasureLines& out, const PlatePicture& picture) {
  const std::string conditions = fmt::format(
      "mean of {} frames of {} x {} pixels of the plate at {:g} K against the sensor model without noise; "
      "fitted: contrast ({:.4g} K), level, rotation, scale and position (shift {:.3f} pixels)",
      picture.seen.frames, picture.seen.kelvin.cols, picture.seen.kelvin.rows, picture.seen.set_delta_t_k,
      picture.contrast_k, picture.moved_px);
  const double relative = normal_z95 / std::sqrt(2.0 * static_cast<double>(picture.seen.kelvin.total()));
  const auto line = [&](const char* name, double value) {
    out.lines.push_back(measure_line(name, value, {value * (1 - relative), value * (1 + relative)}, conditions));
  };
  line("picture_residual", picture.residual_k);
  if (const auto ratio = picture.residual_over_noise()) line("picture_residual_over_noise", *ratio);
  out.picture = panels_of(picture);
}

/// Returns the definition of "mtf_x_model" for "mtf_x (corner)_model"; empty for an unknown quantity.
std::string_view definition_of(const std::string& measure) {
  const std::size_t place = measure.find(" ("), end = measure.find(')');
  const bool with_place = place != std::string::npos && end != std::string::npos && end > place;
  const Quantity* quantity = find_quantity(with_place ? measure.substr(0, place) + measure.substr(end + 1) : measure);
  return quantity == nullptr ? std::string_view() : quantity->definition;
}

Json line_json(const MeasureLine& line) {
  const std::string_view definition = definition_of(line.measure);
  Json json{{"measure", line.measure},
            {"unit", line.unit},
            {"definition", definition.empty() ? Json() : Json(definition)},
            {"value", json_number(line.value)},
            {"ci95", json_interval(line.ci95)},
            {"conditions", line.conditions}};
  if (line.expanded) json["expanded_ci95"] = json_interval(*line.expanded);
  return json;
}

Json panels_json(const PlatePanels& panels) {
  Json outlines = Json::array();
  for (const Polygon& outline : panels.outlines) {
    Json corners = Json::array();
    for (const cv::Point2d& p : outline) corners.push_back({json_number(p.x), json_number(p.y)});
    outlines.push_back(std::move(corners));
  }
  return {{"width", panels.width},
          {"height", panels.height},
          {"black_k", json_number(panels.black_k)},
          {"white_k", json_number(panels.white_k)},
          {"difference_k", json_number(panels.difference_k)},
          {"outlines_px", outlines},
          {"seen_png", panels.seen},
          {"expected_png", panels.expected},
          {"difference_png", panels.difference}};
}

PlatePanels panels_from(const JsonReader& picture) {
  PlatePanels panels;
  panels.width = static_cast<int>(picture.at("width").whole());
  panels.height = static_cast<int>(picture.at("height").whole());
  panels.black_k = picture.at("black_k").number();
  panels.white_k = picture.at("white_k").number();
  panels.difference_k = picture.at("difference_k").number();
  for (const JsonReader& corners : picture.at("outlines_px").elements()) {
    Polygon outline;
    for (const JsonReader& corner : corners.elements()) {
      const Interval place = corner.interval();
      outline.emplace_back(place.low.value_or(0), place.high.value_or(0));
    }
    panels.outlines.push_back(std::move(outline));
  }
  panels.seen = picture.at("seen_png").text();
  panels.expected = picture.at("expected_png").text();
  panels.difference = picture.at("difference_png").text();
  return panels;
}

Json lines_json(const MeasureLines& found) {
  Json lines = Json::array();
  for (const MeasureLine& line : found.lines) lines.push_back(line_json(line));
  return lines;
}

Json side_json(const std::optional<CameraMeasures>& measures) {
  if (!measures) return nullptr;
  const MeasureLines found = measure_lines(*measures);
  Json json{{"quantities", lines_json(found)}, {"noise", nullptr}};  // noise first, as in the files of every version
  for (const MeasureRow& row : measure_table()) json[std::string(row.key)] = row.to_json(*measures);
  json["maps"] = pixel_maps_json(found.maps);
  json["picture"] = found.picture ? panels_json(*found.picture) : Json();
  json["reasons"] = found.reasons;
  return json;
}

/// Returns whether all pictures that a page shows are valid.
bool drawable(const std::optional<MeasureLines>& side) {
  if (side && !drawable(side->maps)) return false;
  if (!side || !side->picture) return true;
  const PlatePanels& panels = *side->picture;
  return panels.width > 0 && panels.height > 0 && is_base64(panels.seen) && is_base64(panels.expected) &&
         is_base64(panels.difference);
}

std::optional<MeasureLines> side_from(const JsonReader& side) {
  if (side.is_null()) return std::nullopt;
  MeasureLines found;
  for (const JsonReader& line : side.at("quantities").elements()) {
    found.lines.push_back({line.at("measure").text(), line.at("unit").text(), line.at("value").optional_number(),
                           line.at("ci95").interval(), line.at("conditions").text()});
    const JsonReader expanded = line.at_if_there("expanded_ci95");
    if (!expanded.is_null()) found.lines.back().expanded = expanded.interval();
  }
  for (const MeasureRow& row : measure_table()) {
    const JsonReader part = side.at_if_there(std::string(row.key));
    if (row.read != nullptr && !part.is_null()) row.read(found, part);
  }
  const JsonReader picture = side.at_if_there("picture");
  if (!picture.is_null()) found.picture = panels_from(picture);
  found.maps = pixel_maps_from(side.at_if_there("maps"));
  found.reasons = side.at("reasons").texts();
  return found;
}

}  // namespace

MeasureLine measure_line(std::string name, std::optional<double> value, const Interval& ci95, std::string conditions) {
  const Quantity* quantity = find_quantity(name);
  const std::string unit(quantity == nullptr ? "1" : quantity->unit);
  return {std::move(name), unit, value, ci95, std::move(conditions)};
}

Json estimate_json(const Estimate& found) {
  return {{"value", json_number(found.value)}, {"ci95", {json_number(found.low), json_number(found.high)}}};
}

Estimate estimate_from(const JsonReader& found) {
  const Interval interval = found.at("ci95").interval();
  const double value = found.at("value").number();
  return {value, interval.low.value_or(value), interval.high.value_or(value)};
}

MeasureLines measure_lines(const CameraMeasures& measures) {
  MeasureLines found;
  for (const MeasureRow& row : measure_table()) row.add(found, measures);
  if (measures.picture) add_picture(found, *measures.picture);
  found.maps = pixel_maps(measures);
  found.reasons.insert(found.reasons.end(), measures.reasons.begin(), measures.reasons.end());
  return found;
}

std::vector<MeasuredQuantity> quantities_of(const MeasureLines& lines) {
  std::vector<MeasuredQuantity> quantities;
  for (const MeasureLine& line : lines.lines) quantities.push_back({line.measure, line.value, line.ci95});
  return quantities;
}

Json measures_json(const std::optional<CameraMeasures>& main, const std::optional<CameraMeasures>& twin) {
  return {{"main", side_json(main)}, {"twin", side_json(twin)}};
}

Json measures_json(const MeasureLines& main) {
  return {{"main", {{"quantities", lines_json(main)}, {"maps", pixel_maps_json(main.maps)}, {"reasons", main.reasons}}},
          {"twin", nullptr}};
}

Result<SessionMeasures> measures_from(const Json& record) {
  const JsonReader reader(record);
  SessionMeasures measures{side_from(reader.at("main")), side_from(reader.at("twin"))};
  TODBENCH_TRY_VOID(reader.finish());
  if (!drawable(measures.main) || !drawable(measures.twin))
    return fail(ErrorCode::invalid_input, "'picture': expected three PNG files of the same size as base64");
  for (const MeasureRow& row : measure_table()) {
    if (row.valid == nullptr) continue;
    if ((measures.main && !row.valid(*measures.main)) || (measures.twin && !row.valid(*measures.twin)))
      return fail(ErrorCode::invalid_input, std::string(row.mistake));
  }
  return measures;
}

}  // namespace todbench
