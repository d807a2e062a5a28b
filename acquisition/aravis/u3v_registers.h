// What a USB3 Vision camera says in the registers that the standard gives every camera: who it is and how it sends.
// Private to the Aravis back end.
#pragma once

#include <string>

#include "acquisition/aravis/glib_ptr.h"
#include "acquisition/core/result.h"

namespace todbench {

/// A camera that states more bytes for a frame is not opened.
inline constexpr std::uint64_t most_payload_bytes = 64U << 20U;

/// The strings of the bootstrap registers (GenCP 1.1, section 4.3: ABRM), empty where a camera has none. They do not
/// depend on the camera's description.
struct U3vIdentity {
  std::string vendor, model, version, serial;
};
[[nodiscard]] U3vIdentity u3v_identity(ArvDevice* device);

/// Whether the stream registers of a USB3 Vision camera (USB3 Vision 1.0, table 5-8) are such that Aravis may be let
/// near them: it divides by sizes and reserves memory by sizes that it finds there. A GigE camera passes. Errors:
/// `not_found` with the register.
[[nodiscard]] Result<void> check_stream_registers(ArvDevice* device);

}  // namespace todbench
