// SPDX-License-Identifier: GPL-3.0-or-later
// IFOV and distortion: lines of a session and part of measures.json.
#pragma once

#include <optional>

#include "bench/session/measures_record.h"
#include "bench/text/json.h"
#include "bench/text/json_reader.h"
#include "tod/camera_measures/camera_measures.h"

namespace todbench {

/// Adds "ifov_x", "ifov_y", "ifov_stated", "plate_rotation", "keystone_x", "keystone_y", "distortion",
/// "geometry_residual"; for a simulated sensor also "ifov_model".
void add_geometry_lines(MeasureLines& out, const GeometryMeasure& measure);
[[nodiscard]] Json geometry_json(const GeometryMeasure& measure);
/// Parses a record; mistakes are recorded in the reader.
[[nodiscard]] GeometryMap geometry_from(const JsonReader& geometry);
/// Returns whether the picture has a size.
[[nodiscard]] bool geometry_drawable(const std::optional<MeasureLines>& side);

}  // namespace todbench
