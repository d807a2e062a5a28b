// SPDX-License-Identifier: GPL-3.0-or-later
// The text that identifies a camera: SCHEME:NAME. The scheme selects the back end that opens it.
#pragma once

#include <array>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

namespace todbench {

/// Schemes of the back ends of this program.
namespace camera_scheme {
inline constexpr std::string_view gige = "gige";  ///< GigE Vision
inline constexpr std::string_view u3v = "u3v";    ///< USB3 Vision
inline constexpr std::string_view v4l2 = "v4l2";  ///< UVC and other kernel cameras
inline constexpr std::string_view usb = "usb";    ///< USB cameras with a vendor-specific protocol
inline constexpr std::string_view file = "file";  ///< recordings
inline constexpr std::string_view sim = "sim";    ///< simulated sensors
inline constexpr std::array all{gige, u3v, v4l2, usb, file, sim};
}  // namespace camera_scheme

/// Returns "SCHEME:NAME" with the name unchanged: "file:PATH", "sim:sc2000", "gige:192.168.1.10".
[[nodiscard]] std::string camera_id(std::string_view scheme, std::string_view name);

/// Returns the id that contains the identity, "gige:VENDOR-SERIAL": the parts joined by '-'. Characters other than
/// letters, digits, dots and underscores become underscores. Precondition: at least one part.
[[nodiscard]] std::string camera_id(std::string_view scheme, std::initializer_list<std::string_view> identity);

/// Returns the text after "SCHEME:"; empty if the id has a different scheme.
[[nodiscard]] std::optional<std::string> camera_name(std::string_view id, std::string_view scheme);
[[nodiscard]] inline bool has_scheme(std::string_view id, std::string_view scheme) {
  return camera_name(id, scheme).has_value();
}

}  // namespace todbench
