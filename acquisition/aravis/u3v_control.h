// USB3 Vision control messages that are needed before Aravis may open a camera: where its description is, how large it
// is, and its bytes. Source: GenCP 1.1, sections 4.2 to 4.4; USB3 Vision 1.0, section 4.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>

#include "acquisition/core/result.h"

namespace todbench {

/// The strings of a USB device by which it is known.
struct UsbNames {
  std::string vendor, product, serial;
};

struct U3vReading {
  std::uint64_t most_bytes = 0;                ///< of the description as it lies in the camera
  std::chrono::milliseconds patience{30'000};  ///< for the whole
  std::stop_token stop = {};
  std::function<void(std::uint64_t done, std::uint64_t bytes)> on_bytes = {};  ///< in between, on the calling thread
};

struct U3vDescriptionContent {
  std::string content;
  bool zipped = false;
};

/// Reads the first description of the manifest of the camera with these names, and leaves the camera as it was. Nothing
/// where there is no such camera, or another program has it. Errors: `not_found` (its tables cannot be read or state
/// what cannot be; it is too slow), `interrupted`.
[[nodiscard]] Result<std::optional<U3vDescriptionContent>> u3v_read_description(const UsbNames& names,
                                                                                const U3vReading& reading);

}  // namespace todbench
