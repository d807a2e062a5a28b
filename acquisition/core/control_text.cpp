// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/core/control_text.h"

#include <array>
#include <charconv>
#include <cmath>

namespace todbench {

std::optional<double> control_number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::string control_text(double value) {
  std::array<char, 40> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} ? std::string(text.data(), end) : std::string();
}

std::optional<cv::Size> frame_size_of(std::string_view text) {
  cv::Size size;
  const char* end = text.data() + text.size();
  const auto width = std::from_chars(text.data(), end, size.width);
  if (width.ec != std::errc() || width.ptr == end || *width.ptr != 'x') return std::nullopt;
  const auto height = std::from_chars(width.ptr + 1, end, size.height);
  if (height.ec != std::errc() || height.ptr != end) return std::nullopt;
  const bool possible = size.width >= 1 && size.height >= 1 && size.width <= 65535 && size.height <= 65535;
  return possible ? std::optional(size) : std::nullopt;
}

std::string frame_size_text(cv::Size size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

}  // namespace todbench
