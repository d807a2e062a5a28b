// SPDX-License-Identifier: GPL-3.0-or-later
// Serial ports: RS-232, USB adapters and USB instruments with a serial interface (/dev/ttyS0, /dev/ttyUSB0,
// /dev/ttyACM0).
#pragma once

#include <string>

#include "acquisition/base/descriptor.h"
#include "acquisition/base/result.h"
#include "tod/instruments/instrument_table.h"

namespace todbench {

/// Opens a port in raw mode, non-blocking and exclusive, and discards received bytes. Errors: `not_found` (the port is
/// absent or in use, the settings are refused, or access is denied; in the last case the message states the remedy).
[[nodiscard]] Result<Descriptor> open_serial_port(const std::string& path, const SerialSettings& settings);

}  // namespace todbench
