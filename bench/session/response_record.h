// Response time of a session: its lines and its part of measures.json.
#pragma once

#include <optional>

#include "bench/session/measures_record.h"
#include "bench/text/json.h"
#include "bench/text/json_reader.h"
#include "tod/camera_measures/camera_measures.h"

namespace todbench {

/// "response_time", and "response_time_rise" and "response_time_fall" where they can be told.
void add_response_lines(MeasureLines& out, const ResponseMeasure& measure);
[[nodiscard]] Json response_json(const ResponseMeasure& measure);
/// What a record says; mistakes stay with the reader.
[[nodiscard]] ResponseCurve response_from(const JsonReader& response);

}  // namespace todbench
