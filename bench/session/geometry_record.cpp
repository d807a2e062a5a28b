// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/geometry_record.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "acquisition/base/normal.h"

namespace todbench {
namespace {

/// Joins each side with a relative standard uncertainty.
Interval joined(const GeometryValue& found, double relative_u) {
  const double stated = normal_z95 * relative_u * found.value;
  return {.low = found.value - std::hypot(found.value - found.low, stated),
          .high = found.value + std::hypot(found.high - found.value, stated)};
}

Json geometry_value_json(const GeometryValue& found) {
  return {{"value", json_number(found.value)}, {"ci95", {json_number(found.low), json_number(found.high)}}};
}

}  // namespace

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
    const GeometryValue ifov = measure.ifov_mrad(axis);
    MeasureLine line{"ifov_" + std::string(to_string(axis)), "mrad", ifov.value, {ifov.low, ifov.high}, distance};
    if (measure.distance_relative_u) line.expanded = joined(ifov, *measure.distance_relative_u);
    out.lines.push_back(std::move(line));
  }
  const auto exact = [&](const char* name, const char* unit, double value, const char* what) {
    out.lines.push_back({name, unit, value, {value, value}, what});
  };
  exact("ifov_stated", "mrad", measure.stated_ifov_mrad, "IFOV stated in the plan");
  if (measure.model_ifov_mrad) exact("ifov_model", "mrad", *measure.model_ifov_mrad, "IFOV of the sensor model");
  const auto line = [&](const char* name, const char* unit, const GeometryValue& value) {
    out.lines.push_back({name, unit, value.value, {value.low, value.high}, conditions});
  };
  line("plate_rotation", "deg", found.rotation_deg);
  line("keystone_x", "%", found.keystone_x_percent);
  line("keystone_y", "%", found.keystone_y_percent);
  line("distortion", "%", found.distortion_percent);
  if (measure.model_distortion_percent)
    exact("distortion_model", "%", *measure.model_distortion_percent, "distortion of the sensor model, both terms");
  out.lines.push_back({"geometry_residual", "px", found.residual_px, {}, conditions});
  out.geometry = GeometryMap{measure.picture.width * 1.0, measure.picture.height * 1.0, found.places};
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
          {"mm_per_px_x", geometry_value_json(found.mm_per_px_x)},
          {"mm_per_px_y", geometry_value_json(found.mm_per_px_y)},
          {"rotation_deg", geometry_value_json(found.rotation_deg)},
          {"keystone_x_percent", geometry_value_json(found.keystone_x_percent)},
          {"keystone_y_percent", geometry_value_json(found.keystone_y_percent)},
          {"distortion_percent", geometry_value_json(found.distortion_percent)},
          {"residual_px", json_number(found.residual_px)},
          {"farthest_px", json_number(found.farthest_px)},
          {"corner_px", json_number(found.corner_px)},
          {"places", places}};
}

GeometryMap geometry_from(const JsonReader& geometry) {
  const Interval size = geometry.at("picture_px").interval();
  GeometryMap map{size.low.value_or(0), size.high.value_or(0), {}};
  for (const JsonReader& place : geometry.at("places").elements()) {
    const Interval found = place.at("found_px").interval(), left = place.at("residual_px").interval();
    map.places.push_back({place.at("triangle").text(),
                          {found.low.value_or(0), found.high.value_or(0)},
                          {left.low.value_or(0), left.high.value_or(0)}});
  }
  return map;
}

bool geometry_drawable(const std::optional<MeasureLines>& side) {
  return !side || !side->geometry || (side->geometry->width > 0 && side->geometry->height > 0);
}

}  // namespace todbench
