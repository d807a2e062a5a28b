// IFOV and distortion of a session: their lines and their part of measures.json.
#pragma once

#include <optional>

#include "bench/session/measures_record.h"
#include "bench/text/json.h"
#include "bench/text/json_reader.h"
#include "tod/camera_measures/camera_measures.h"

namespace todbench {

/// "ifov_x", "ifov_y", "ifov_stated", "plate_rotation", "keystone_x", "keystone_y", "distortion", "geometry_residual";
/// of a simulated sensor "ifov_model".
void add_geometry_lines(MeasureLines& out, const GeometryMeasure& measure);
[[nodiscard]] Json geometry_json(const GeometryMeasure& measure);
/// What a record says; mistakes stay with the reader.
[[nodiscard]] GeometryMap geometry_from(const JsonReader& geometry);
/// A picture has a size.
[[nodiscard]] bool geometry_drawable(const std::optional<MeasureLines>& side);

}  // namespace todbench
