// The text that names a camera: SCHEME:NAME. What stands before the colon says which back end opens it.
#pragma once

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
inline constexpr std::string_view usb = "usb";    ///< cameras with a protocol of their own on USB
inline constexpr std::string_view file = "file";  ///< recordings
inline constexpr std::string_view sim = "sim";    ///< simulated sensors
}  // namespace camera_scheme

/// "SCHEME:NAME", the name as it is: "file:PATH", "sim:sc2000", "gige:192.168.1.10".
[[nodiscard]] std::string camera_id(std::string_view scheme, std::string_view name);

/// By identity, "gige:VENDOR-SERIAL": the parts joined by '-'; characters of them that are no letter, digit, dot or
/// underscore become underscores. Precondition: there is a part.
[[nodiscard]] std::string camera_id(std::string_view scheme, std::initializer_list<std::string_view> identity);

/// What follows "SCHEME:"; nothing where the id is of another scheme.
[[nodiscard]] std::optional<std::string> camera_name(std::string_view id, std::string_view scheme);
[[nodiscard]] inline bool has_scheme(std::string_view id, std::string_view scheme) {
  return camera_name(id, scheme).has_value();
}

}  // namespace todbench
