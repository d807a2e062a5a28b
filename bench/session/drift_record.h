// SPDX-License-Identifier: GPL-3.0-or-later
// Drift after a correction: lines of a session and part of measures.json.
#pragma once

#include <optional>

#include "bench/session/measures_record.h"
#include "bench/text/json.h"
#include "bench/text/json_reader.h"
#include "tod/camera_measures/camera_measures.h"

namespace todbench {

/// Adds "drift_rate" and "drift_pattern_rate" over the observed time, and for an exponential approach
/// "drift_time_constant" and "drift_pattern_time_constant".
void add_drift_lines(MeasureLines& out, const DriftMeasure& measure);
[[nodiscard]] Json drift_json(const DriftMeasure& measure);
/// Parses a record; mistakes are recorded in the reader.
[[nodiscard]] DriftLaw drift_from(const JsonReader& drift);
/// Returns whether every group has a number.
[[nodiscard]] bool drift_drawable(const std::optional<MeasureLines>& side);

}  // namespace todbench
