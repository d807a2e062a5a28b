// Serial ports: RS-232, and USB adapters and instruments that look like one (/dev/ttyS0, /dev/ttyUSB0, /dev/ttyACM0).
#pragma once

#include <string>

#include "acquisition/core/result.h"
#include "tod/instruments/descriptor.h"
#include "tod/instruments/instrument_table.h"

namespace todbench {

/// Opens a port for bytes as they are, not blocking, for this program alone, and drops what waited in it. `not_found`
/// where there is none, it is in use, or it refuses the settings; what to do about missing rights is said.
[[nodiscard]] Result<Descriptor> open_serial_port(const std::string& path, const SerialSettings& settings);

}  // namespace todbench
