// Instruments from their TOML files (docs/instruments.md).
#pragma once

#include <string_view>

#include "acquisition/core/result.h"
#include "bench/plan/resources.h"
#include "tod/instruments/instrument_table.h"

namespace todbench {

/// By name ("scpi-black-body") or file. `invalid_input` with file and line for a key that is unknown, missing or out of
/// its range, and for words that cannot work together.
[[nodiscard]] Result<InstrumentTable> load_instrument(std::string_view reference);
/// The same from text already read.
[[nodiscard]] Result<InstrumentTable> parse_instrument(const Resource& resource);

}  // namespace todbench
