// Keeps Aravis from evaluating what a camera must not have it evaluate. Private to the Aravis back end.
//
// Aravis follows every reference of a description, reserves what a length says and divides by what a register holds,
// but only when it is asked for a feature; before that it only builds nodes from the text. So the text is read and
// looked at before Aravis opens a camera, and compared with what Aravis has before anything is asked of it.
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

struct DescriptionReading {
  std::chrono::milliseconds patience{30'000};  ///< for the transfer
  std::stop_token stop = {};
  std::function<void(std::string_view sentence)> on_progress = {};  ///< about once a second
};

/// The description of the GigE camera at this address, read from where it says that it is, unzipped, and safe to be
/// evaluated; nothing where the camera does not say where. Errors: `not_found` with the sentence about what is wrong,
/// `interrupted`.
[[nodiscard]] Result<std::optional<std::string>> read_safe_description(const std::string& ipv4,
                                                                       const DescriptionReading& reading);

/// The same of a USB3 Vision camera, from the manifest in its registers; nothing where there is no camera of these
/// names, or another program has it.
[[nodiscard]] Result<std::optional<std::string>> read_safe_description(const UsbNames& names,
                                                                       const DescriptionReading& reading);

/// Looks at the description that Aravis has of this device, and keeps what it finds with the device, for
/// feature_fault(). To be called before anything is asked of it. `expected`: what it has to be. Errors: `not_found`.
[[nodiscard]] Result<void> guard_device(ArvDevice* device, const std::optional<std::string>& expected);

/// Why this feature must not be evaluated, as a sentence about it; nothing: it may be. Asks the camera for the lengths
/// of registers that only it knows, and guards a device that nobody has guarded.
[[nodiscard]] std::optional<std::string> feature_fault(ArvDevice* device, const std::string& feature);

}  // namespace todbench
