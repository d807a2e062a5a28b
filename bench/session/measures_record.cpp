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

void measure_line_fields(JsonFields& json, MeasureLine& line) {
  json.value("measure", line.measure);
  json.value("unit", line.unit);
  const std::string_view definition = definition_of(line.measure);
  json.derived("definition", definition.empty() ? Json() : Json(definition));
  json.value("value", line.value);
  json.value("ci95", line.ci95);
  json.value("conditions", line.conditions);
  json.if_any("expanded_ci95", line.expanded);
}

void panels_fields(JsonFields& json, PlatePanels& panels) {
  std::vector<std::vector<Interval>> outlines;
  for (const Polygon& outline : panels.outlines) {
    outlines.emplace_back();
    for (const cv::Point2d& p : outline) outlines.back().push_back({p.x, p.y});
  }
  json.value("width", panels.width);
  json.value("height", panels.height);
  json.value("black_k", panels.black_k);
  json.value("white_k", panels.white_k);
  json.value("difference_k", panels.difference_k);
  json.value("outlines_px", outlines);
  json.value("seen_png", panels.seen);
  json.value("expected_png", panels.expected);
  json.value("difference_png", panels.difference);
  if (!json.reading()) return;
  for (const std::vector<Interval>& outline : outlines) {
    panels.outlines.emplace_back();
    for (const Interval& p : outline) panels.outlines.back().emplace_back(p.low.value_or(0), p.high.value_or(0));
  }
}

/// Describes a side. `measures`: source of the parts that are not read; null in reading.
void side_fields(JsonFields& json, MeasureLines& side, const CameraMeasures* measures) {
  json.value("quantities", side.lines, measure_line_fields);
  json.derived("noise", nullptr);  // noise first, as in the files of every version
  for (const MeasureRow& row : measure_table()) {
    const std::string key(row.key);
    if (row.fields != nullptr)
      row.fields(json, key, side);
    else if (measures != nullptr)
      json.derived(key, row.to_json(*measures));
  }
  json.later("maps", side.maps, pixel_map_fields);
  json.later("picture", side.picture, panels_fields);
  json.value("reasons", side.reasons);
}

/// Description of a record of both sides.
struct SidesFields {
  const CameraMeasures *main = nullptr, *twin = nullptr;  ///< sources of the parts that are not read

  void operator()(JsonFields& json, SessionMeasures& record) const {
    json.value("main", record.main, [&](JsonFields& part, MeasureLines& side) { side_fields(part, side, main); });
    json.value("twin", record.twin, [&](JsonFields& part, MeasureLines& side) { side_fields(part, side, twin); });
  }
};

SidesFields fields_of(const std::optional<CameraMeasures>& main, const std::optional<CameraMeasures>& twin) {
  return {main ? &*main : nullptr, twin ? &*twin : nullptr};
}

SessionMeasures lines_of(const std::optional<CameraMeasures>& main, const std::optional<CameraMeasures>& twin) {
  SessionMeasures sides;
  if (main) sides.main = measure_lines(*main);
  if (twin) sides.twin = measure_lines(*twin);
  return sides;
}

/// Returns whether all pictures that a page shows are valid.
bool drawable(const std::optional<MeasureLines>& side) {
  if (side && !drawable(side->maps)) return false;
  if (!side || !side->picture) return true;
  const PlatePanels& panels = *side->picture;
  return panels.width > 0 && panels.height > 0 && is_base64(panels.seen) && is_base64(panels.expected) &&
         is_base64(panels.difference);
}

}  // namespace

MeasureLine measure_line(std::string name, std::optional<double> value, const Interval& ci95, std::string conditions) {
  const Quantity* quantity = find_quantity(name);
  const std::string unit(quantity == nullptr ? "1" : quantity->unit);
  return {std::move(name), unit, value, ci95, std::move(conditions)};
}

void estimate_fields(JsonFields& json, Estimate& found) {
  Interval ci95 = found.interval();
  json.value("value", found.value);
  json.value("ci95", ci95);
  found.low = ci95.low.value_or(found.value);
  found.high = ci95.high.value_or(found.value);
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
  return printed_json(lines_of(main, twin), fields_of(main, twin));
}

Result<Json> measures_record(const std::optional<CameraMeasures>& main, const std::optional<CameraMeasures>& twin) {
  return json_of(lines_of(main, twin), fields_of(main, twin));
}

Result<Json> measures_record(const MeasureLines& main) {
  return json_of(main, [](JsonFields& json, MeasureLines& described) {
    json.value("main", described, [](JsonFields& part, MeasureLines& side) {
      part.value("quantities", side.lines, measure_line_fields);
      part.value("maps", side.maps, pixel_map_fields);
      part.value("reasons", side.reasons);
    });
    json.derived("twin", nullptr);
  });
}

Result<SessionMeasures> measures_from(const Json& record) {
  TODBENCH_TRY(SessionMeasures measures, from_json<SessionMeasures>(record, SidesFields{}));
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
