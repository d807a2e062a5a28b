// SPDX-License-Identifier: GPL-3.0-or-later
// Prevents Aravis from evaluating unsafe descriptions of cameras. Private to the Aravis back end.
//
// When a feature is requested, Aravis follows every reference of the description, allocates memory by stated lengths
// and divides by register values. Before the first request, Aravis only builds nodes from the text. The guard therefore
// reads and checks the text before Aravis opens the camera. Before any feature is requested, it compares the checked
// text with the text that Aravis holds.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

#include "acquisition/aravis/glib_ptr.h"
#include "acquisition/aravis/u3v_control.h"

namespace todbench {

/// Limits and progress of reading a description.
struct DescriptionReading {
  std::chrono::milliseconds patience{30'000};  ///< time limit of the whole transfer
  std::stop_token stop = {};
  std::function<void(std::string_view sentence)> on_progress = {};  ///< about once a second
};

/// Reads the description of the GigE camera at this address from the location that the camera states. Returns it
/// unzipped and safe to evaluate; empty if the camera reports no location. Errors: `not_found` with the reason,
/// `interrupted`.
[[nodiscard]] Result<std::optional<std::string>> read_safe_description(const std::string& ipv4,
                                                                       const DescriptionReading& reading);

/// Reads the description of a USB3 Vision camera through the manifest in its registers. Errors as for GigE. Empty
/// if no camera has these names or a different program uses the camera.
[[nodiscard]] Result<std::optional<std::string>> read_safe_description(const UsbNames& names,
                                                                       const DescriptionReading& reading);

/// Checks the description that Aravis holds for this device, and stores the result with the device for feature_fault().
/// Call before any feature is requested. `expected`: text that the description must equal. Errors: `not_found`.
[[nodiscard]] Result<void> guard_device(ArvDevice* device, const std::optional<std::string>& expected);

/// Returns one sentence with the reason why this feature must not be evaluated; empty if it may be evaluated. Reads
/// those register lengths that are stored only in the camera. If the description of the device has not been checked
/// yet, checks it first.
[[nodiscard]] std::optional<std::string> feature_fault(ArvDevice* device, const std::string& feature);

}  // namespace todbench
