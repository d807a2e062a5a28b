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

/// Describes a point as [x, y].
void place_field(JsonFields& json, const std::string& key, cv::Point2d& point) {
  Interval place{point.x, point.y};
  json.value(key, place);
  point = {place.low.value_or(0), place.high.value_or(0)};
}

void geometry_place_fields(JsonFields& json, GeometryPlace& place) {
  json.value("triangle", place.triangle);
  place_field(json, "found_px", place.found_px);
  place_field(json, "residual_px", place.residual_px);
}

/// Describes the size of the picture. A record that was edited may have any numbers.
void picture_size_field(JsonFields& json, cv::Size& picture) {
  json.derived("picture_px", std::vector{picture.width, picture.height});
  if (!json.reading()) return;
  const auto pixels = [](const std::optional<double>& side) {
    constexpr double most_px = 1e6;
    return static_cast<int>(std::clamp(side.value_or(0), 0.0, most_px));
  };
  Interval size;
  json.value("picture_px", size);
  picture = {pixels(size.low), pixels(size.high)};
}

void geometry_fields(JsonFields& json, GeometryMeasure& measure) {
  PlateGeometry& found = measure.geometry;
  // Records of earlier versions have no line of sight; figures need none of these values.
  const bool line_of_sight = !json.reading() || json.has("centre_x_mm");
  if (line_of_sight) {
    json.value("plate", measure.plate);
    json.derived("frames", measure.frames);
    json.derived("set_delta_t_k", measure.set_delta_t_k);
    json.value("distance_m", measure.distance_m);
    json.value("distance_relative_u", measure.distance_relative_u);
    json.value("stated_ifov_mrad", measure.stated_ifov_mrad);
  }
  picture_size_field(json, measure.picture);
  if (line_of_sight) {
    json.value("mm_per_px_x", found.mm_per_px_x, estimate_fields);
    json.value("mm_per_px_y", found.mm_per_px_y, estimate_fields);
    json.value("centre_x_mm", found.centre_x_mm, estimate_fields);
    json.value("centre_y_mm", found.centre_y_mm, estimate_fields);
    json.value("rotation_deg", found.rotation_deg, estimate_fields);
  }
  json.derived("keystone_x_percent", found.keystone_x_percent, estimate_fields);
  json.derived("keystone_y_percent", found.keystone_y_percent, estimate_fields);
  json.derived("distortion_percent", found.distortion_percent, estimate_fields);
  json.derived("residual_px", found.residual_px);
  json.derived("farthest_px", found.farthest_px);
  json.derived("corner_px", found.corner_px);
  json.value("places", found.places, geometry_place_fields);
}

bool drawable(const GeometryMeasure& geometry) {
  return geometry.picture.width > 0 && geometry.picture.height > 0;
}

}  // namespace

MeasureRow geometry_row() {
  return {.key = "geometry",
          .add =
              [](MeasureLines& out, const CameraMeasures& measures) {
                if (measures.geometry) add_geometry_lines(out, *measures.geometry);
              },
          .fields = measure_part<&MeasureLines::geometry, geometry_fields>,
          .valid = [](const MeasureLines& lines) { return !lines.geometry || drawable(*lines.geometry); },
          .mistake = "'geometry.picture_px': expected numbers above 0"};
}

}  // namespace todbench
