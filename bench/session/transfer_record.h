// SPDX-License-Identifier: GPL-3.0-or-later
// Signal transfer of a session: part of measures.json.
#pragma once

#include <optional>

#include "bench/session/measures_record.h"
#include "bench/text/json.h"
#include "bench/text/json_reader.h"
#include "tod/camera_measures/camera_measures.h"

namespace todbench {

[[nodiscard]] Json transfer_json(const TransferMeasure& transfer);
/// Parses a record; mistakes are recorded in the reader.
[[nodiscard]] TransferCurve transfer_from(const JsonReader& transfer);

}  // namespace todbench
