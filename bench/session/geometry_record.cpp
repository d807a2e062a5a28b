// SPDX-License-Identifier: GPL-3.0-or-later
// IFOV and distortion in measures.json.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "acquisition/base/normal.h"
#include "bench/session/measure_row.h"

namespace todbench {
namespace {

/// Joins each side with a relative standard uncertainty.
Interval joined(const Estimate& found, double relative_u) {
  const double stated = normal_z95 * relative_u * found.value;
  return {.low = found.value - std::hypot(found.value - found.low, stated),
          .high = found.value + std::hypot(found.high - found.value, stated)};
}

void add_geometry_lines(MeasureLines& out, const GeometryMeasure& measure) {
  const PlateGeometry& found = measure.geometry;
  const std::string conditions = fmt::format(
      "{} triangles of plate {} at {:g} K, mean of {} frames, up to {:.0f} % of the distance to the picture's corner",
      found.places.size(), measure.plate, measure.set_delta_t_k, measure.frames,
      100 * found.farthest_px / found.corner_px);
  std::string distance = fmt::format("{}, at a distance of {:g} m", conditions, measure.distance_m);
  distance += measure.distance_relative_u ? fmt::format(" with a budget uncertainty of {:.2g} % (95 %)",
                                                        100 * normal_z95 * *measure.distance_relative_u)
                                          : " without a stated uncertainty";
  for (const EdgeAxis axis : {EdgeAxis::x, EdgeAxis::y}) {
    const Estimate ifov = measure.ifov_mrad(axis);
    MeasureLine line = measure_line("ifov_" + std::string(to_string(axis)), ifov.value, ifov.interval(), distance);
    if (measure.distance_relative_u) line.expanded = joined(ifov, *measure.distance_relative_u);
    out.lines.push_back(std::move(line));
  }
  for (const EdgeAxis axis : {EdgeAxis::x, EdgeAxis::y}) {
    const Estimate field = measure.field_of_view_deg(axis);
    MeasureLine line = measure_line("field_of_view_" + std::string(to_string(axis)), field.value, field.interval(),
                                    distance + "; distortion continued to the border of the picture");
    if (measure.distance_relative_u) line.expanded = joined(field, *measure.distance_relative_u);
    out.lines.push_back(std::move(line));
  }
  const auto exact = [&](const char* name, double value, const char* what) {
    out.lines.push_back(measure_line(name, value, {value, value}, what));
  };
  exact("ifov_stated", measure.stated_ifov_mrad, "IFOV stated in the plan");
  if (measure.model_ifov_mrad) exact("ifov_model", *measure.model_ifov_mrad, "IFOV of the sensor model");
  const auto line = [&](const char* name, const Estimate& value) {
    out.lines.push_back(measure_line(name, value.value, value.interval(), conditions));
  };
  line("aspect_ratio", measure.aspect_ratio());
  line("plate_rotation", found.rotation_deg);
  line("keystone_x", found.keystone_x_percent);
  line("keystone_y", found.keystone_y_percent);
  line("distortion", found.distortion_percent);
  if (measure.model_distortion_percent)
    exact("distortion_model", *measure.model_distortion_percent, "distortion of the sensor model, both terms");
  out.lines.push_back(measure_line("geometry_residual", found.residual_px, {}, conditions));
  out.geometry = measure;
}

Json geometry_json(const GeometryMeasure& measure) {
  const PlateGeometry& found = measure.geometry;
  Json places = Json::array();
  for (const GeometryPlace& place : found.places) {
    places.push_back({{"triangle", place.triangle},
                      {"found_px", {json_number(place.found_px.x), json_number(place.found_px.y)}},
                      {"residual_px", {json_number(place.residual_px.x), json_number(place.residual_px.y)}}});
  }
  return {{"plate", measure.plate},
          {"frames", measure.frames},
          {"set_delta_t_k", measure.set_delta_t_k},
          {"distance_m", measure.distance_m},
          {"distance_relative_u", json_number(measure.distance_relative_u)},
          {"stated_ifov_mrad", measure.stated_ifov_mrad},
          {"picture_px", {measure.picture.width, measure.picture.height}},
          {"mm_per_px_x", estimate_json(found.mm_per_px_x)},
          {"mm_per_px_y", estimate_json(found.mm_per_px_y)},
          {"centre_x_mm", estimate_json(found.centre_x_mm)},
          {"centre_y_mm", estimate_json(found.centre_y_mm)},
          {"rotation_deg", estimate_json(found.rotation_deg)},
          {"keystone_x_percent", estimate_json(found.keystone_x_percent)},
          {"keystone_y_percent", estimate_json(found.keystone_y_percent)},
          {"distortion_percent", estimate_json(found.distortion_percent)},
          {"residual_px", json_number(found.residual_px)},
          {"farthest_px", json_number(found.farthest_px)},
          {"corner_px", json_number(found.corner_px)},
          {"places", places}};
}

void read_line_of_sight(const JsonReader& geometry, GeometryMeasure& found) {
  found.plate = geometry.at("plate").text();
  found.distance_m = geometry.at("distance_m").number();
  found.distance_relative_u = geometry.at("distance_relative_u").optional_number();
  found.stated_ifov_mrad = geometry.at("stated_ifov_mrad").number();
  found.geometry.mm_per_px_x = estimate_from(geometry.at("mm_per_px_x"));
  found.geometry.mm_per_px_y = estimate_from(geometry.at("mm_per_px_y"));
  found.geometry.centre_x_mm = estimate_from(geometry.at("centre_x_mm"));
  found.geometry.centre_y_mm = estimate_from(geometry.at("centre_y_mm"));
  found.geometry.rotation_deg = estimate_from(geometry.at("rotation_deg"));
}

GeometryMeasure geometry_from(const JsonReader& geometry) {
  const Interval size = geometry.at("picture_px").interval();
  const auto pixels = [](const std::optional<double>& side) {
    constexpr double most_px = 1e6;  // of a record that may have been edited
    return static_cast<int>(std::clamp(side.value_or(0), 0.0, most_px));
  };
  GeometryMeasure found;
  found.picture = {pixels(size.low), pixels(size.high)};
  // Records of earlier versions have no line of sight; figures need none of these values.
  if (!geometry.at_if_there("centre_x_mm").is_null()) read_line_of_sight(geometry, found);
  for (const JsonReader& place : geometry.at("places").elements()) {
    const Interval at = place.at("found_px").interval(), left = place.at("residual_px").interval();
    found.geometry.places.push_back({place.at("triangle").text(),
                                     {at.low.value_or(0), at.high.value_or(0)},
                                     {left.low.value_or(0), left.high.value_or(0)}});
  }
  return found;
}

bool drawable(const GeometryMeasure& geometry) {
  return geometry.picture.width > 0 && geometry.picture.height > 0;
}

}  // namespace

MeasureRow geometry_row() {
  return {
      .key = "geometry",
      .add =
          [](MeasureLines& out, const CameraMeasures& measures) {
            if (measures.geometry) add_geometry_lines(out, *measures.geometry);
          },
      .to_json =
          [](const CameraMeasures& measures) { return measures.geometry ? geometry_json(*measures.geometry) : Json(); },
      .read = [](MeasureLines& out, const JsonReader& part) { out.geometry = geometry_from(part); },
      .valid = [](const MeasureLines& lines) { return !lines.geometry || drawable(*lines.geometry); },
      .mistake = "'geometry.picture_px': expected numbers above 0"};
}

}  // namespace todbench
