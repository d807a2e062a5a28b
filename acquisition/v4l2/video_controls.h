// SPDX-License-Identifier: GPL-3.0-or-later
// Controls of a V4L2 device by name, values as text. Private to the V4L2 back end.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "acquisition/v4l2/video_device.h"

namespace todbench {

/// A control of a device.
struct VideoControl {
  std::string name;  ///< letters and digits of the driver's name: "White Balance, Automatic" is "WhiteBalanceAutomatic"
  std::uint32_t id = 0, type = 0;
  std::int64_t minimum = 0, maximum = 0;
  bool readable = false, writable = false;
  std::map<std::int64_t, std::string> menu;  ///< value -> entry, for menus
};

/// Lists integers, booleans, menus and buttons of a device; other kinds are skipped.
[[nodiscard]] std::vector<VideoControl> list_controls(const VideoDevice& device);
[[nodiscard]] const VideoControl* find_control(const std::vector<VideoControl>& controls, const std::string& name);

/// Returns the value as text; for a menu its entry. Error: `invalid_input` (not readable).
[[nodiscard]] Result<std::string> get_control(const VideoDevice& device, const VideoControl& control);
/// Sets the value. A menu accepts an entry or its number; a button ignores the value. Error: `invalid_input` (not a
/// value of this control, or refused).
[[nodiscard]] Result<void> set_control(const VideoDevice& device, const VideoControl& control,
                                       const std::string& value);

/// Returns the button that corrects the non-uniformity: its name contains NUC, FFC, shutter, flat field or calibration.
[[nodiscard]] const VideoControl* nonuniformity_button(const std::vector<VideoControl>& controls);

}  // namespace todbench
