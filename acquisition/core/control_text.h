// SPDX-License-Identifier: GPL-3.0-or-later
// Conversion between numbers and the text values of camera features.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace todbench {

/// Returns the finite number that the whole text represents; empty for any other text.
[[nodiscard]] std::optional<double> control_number(std::string_view text);
/// Returns the shortest text that control_number() reads back as the same number.
[[nodiscard]] std::string control_text(double value);

/// Returns width and height of a text like "640x512"; empty for other texts or a side outside 1 ... 65535.
[[nodiscard]] std::optional<cv::Size> frame_size_of(std::string_view text);
[[nodiscard]] std::string frame_size_text(cv::Size size);

/// Features that a source offers in addition to those of the camera: the frame size that the camera is expected to send
/// (frame_size_text()), and the name of the camera's command for a non-uniformity correction.
inline constexpr const char* frame_size_feature = "FrameSize";
inline constexpr const char* nuc_command_feature = "NonuniformityCommand";

}  // namespace todbench
