// SPDX-License-Identifier: GPL-3.0-or-later
// Opens the connection to an instrument.
#pragma once

#include <memory>
#include <stop_token>

#include "acquisition/base/result.h"
#include "tod/instruments/instrument_line.h"
#include "tod/instruments/instrument_table.h"

namespace todbench {

/// Opens the connection to an address. `serial`: settings if the address is a serial port. Errors: `not_found` (no
/// instrument, no access, no serial port, or timeout), `interrupted`; for VXI-11 also `timeout`, `disconnected`.
[[nodiscard]] Result<std::unique_ptr<InstrumentLine>> open_line(const InstrumentAddress& address,
                                                                const SerialSettings& serial,
                                                                InstrumentLine::TimePoint deadline,
                                                                const std::stop_token& stop);

}  // namespace todbench
