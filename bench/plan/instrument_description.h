// SPDX-License-Identifier: GPL-3.0-or-later
// Instruments from their TOML files (docs/reference/instruments.md).
#pragma once

#include <string_view>

#include "acquisition/base/result.h"
#include "bench/plan/resources.h"
#include "tod/instruments/instrument_table.h"

namespace todbench {

/// Loads an instrument by name ("scpi-black-body") or file. Errors: `invalid_input` with file and line (key unknown,
/// missing or out of range; contradictory commands).
[[nodiscard]] Result<InstrumentTable> load_instrument(std::string_view reference);
/// Parses text already read.
[[nodiscard]] Result<InstrumentTable> parse_instrument(const Resource& resource);

}  // namespace todbench
