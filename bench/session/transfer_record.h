// Signal transfer of a session: its part of measures.json.
#pragma once

#include <optional>

#include "bench/session/measures_record.h"
#include "bench/text/json.h"
#include "bench/text/json_reader.h"
#include "tod/camera_measures/camera_measures.h"

namespace todbench {

[[nodiscard]] Json transfer_json(const TransferMeasure& transfer);
/// What a record says; mistakes stay with the reader.
[[nodiscard]] TransferCurve transfer_from(const JsonReader& transfer);

}  // namespace todbench
