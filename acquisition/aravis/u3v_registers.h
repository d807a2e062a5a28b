// SPDX-License-Identifier: GPL-3.0-or-later
// Identity and stream registers that the standard defines for every USB3 Vision camera. Private to the Aravis back end.
#pragma once

#include <string>

#include "acquisition/aravis/glib_ptr.h"
#include "acquisition/base/result.h"

namespace todbench {

/// Largest payload of a frame; cameras that report more are not opened.
inline constexpr std::uint64_t most_payload_bytes = 64U << 20U;

/// Strings of the bootstrap registers (GenCP 1.1, section 4.3: ABRM), empty if absent. The strings do not depend on the
/// camera's description.
struct U3vIdentity {
  std::string vendor, model, version, serial;
};
/// Reads the strings from the camera.
[[nodiscard]] U3vIdentity u3v_identity(ArvDevice* device);

/// Checks that the sizes in the stream registers of a USB3 Vision camera (USB3 Vision 1.0, table 5-8) are safe. Aravis
/// divides by these sizes and allocates memory by them. GigE cameras always pass. Error: `not_found` with the name of
/// the register.
[[nodiscard]] Result<void> check_stream_registers(ArvDevice* device);

}  // namespace todbench
