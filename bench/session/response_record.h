// SPDX-License-Identifier: GPL-3.0-or-later
// Response time: lines of a session and part of measures.json.
#pragma once

#include <optional>

#include "bench/session/measures_record.h"
#include "bench/text/json.h"
#include "bench/text/json_reader.h"
#include "tod/camera_measures/camera_measures.h"

namespace todbench {

/// Adds "response_time", and "response_time_rise" and "response_time_fall" if they can be distinguished.
void add_response_lines(MeasureLines& out, const ResponseMeasure& measure);
[[nodiscard]] Json response_json(const ResponseMeasure& measure);
/// Parses a record; mistakes are recorded in the reader.
[[nodiscard]] ResponseCurve response_from(const JsonReader& response);

}  // namespace todbench
