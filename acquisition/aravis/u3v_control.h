// SPDX-License-Identifier: GPL-3.0-or-later
// USB3 Vision control messages that are needed before Aravis opens a camera. The messages read location, size and bytes
// of the camera's description. Source: GenCP 1.1, sections 4.2 to 4.4; USB3 Vision 1.0, section 4.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>

#include "acquisition/base/result.h"

namespace todbench {

/// Strings that identify a USB device.
struct UsbNames {
  std::string vendor, product, serial;
};

/// Limits and progress of reading a description.
struct U3vReading {
  std::uint64_t most_bytes = 0;                ///< maximum size of the description as stored in the camera
  std::chrono::milliseconds patience{30'000};  ///< time limit of the whole read
  std::stop_token stop = {};
  std::function<void(std::uint64_t done, std::uint64_t bytes)> on_bytes = {};  ///< called on the reading thread
};

/// A description as stored in the camera.
struct U3vDescriptionContent {
  std::string content;
  bool zipped = false;
};

/// Reads the first description in the manifest of the camera with these names. Does not change the camera. Empty if
/// there is no such camera or a different program uses it. Errors: `not_found` (the camera is too slow, or its tables
/// are unreadable or contradictory), `interrupted`.
[[nodiscard]] Result<std::optional<U3vDescriptionContent>> u3v_read_description(const UsbNames& names,
                                                                                const U3vReading& reading);

}  // namespace todbench
