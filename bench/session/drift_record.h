// Drift after a correction of a session: its lines and its part of measures.json.
#pragma once

#include <optional>

#include "bench/session/measures_record.h"
#include "bench/text/json.h"
#include "bench/text/json_reader.h"
#include "tod/camera_measures/camera_measures.h"

namespace todbench {

/// "drift_rate" and "drift_pattern_rate" over the time that was watched, and of an approach "drift_time_constant" and
/// "drift_pattern_time_constant".
void add_drift_lines(MeasureLines& out, const DriftMeasure& measure);
[[nodiscard]] Json drift_json(const DriftMeasure& measure);
/// What a record says; mistakes stay with the reader.
[[nodiscard]] DriftLaw drift_from(const JsonReader& drift);
/// There is a number for each group.
[[nodiscard]] bool drift_drawable(const std::optional<MeasureLines>& side);

}  // namespace todbench
