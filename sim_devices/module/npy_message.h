// SPDX-License-Identifier: GPL-3.0-or-later
// Messages between bench and module: consecutive arrays in NumPy's .npy format, little-endian.
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// Received array; numbers of every accepted type are converted to double.
struct NpyMessage {
  std::vector<std::size_t> shape;
  std::vector<double> values;  ///< last index fastest
};

/// Returns a picture as <f4, two dimensions, rows first.
[[nodiscard]] std::string to_message(const cv::Mat1f& picture);
/// Returns numbers as <f8, one dimension.
[[nodiscard]] std::string to_message(const std::vector<double>& numbers);
/// Returns a text as |u1, one dimension: the header, which is sent first.
[[nodiscard]] std::string to_message(std::string_view text);

/// Location of an array in a stream.
struct NpyPlace {
  std::vector<std::size_t> shape;
  std::size_t type = 0;                ///< index in the table of types in npy_message.cpp
  std::size_t numbers = 0, count = 0;  ///< offset of the first byte of the numbers, and number of values
  std::size_t bytes = 0;               ///< size of the whole message
};
/// Locates the array at the beginning of a stream. Empty if bytes are still missing. Errors: those of read_message().
[[nodiscard]] Result<std::optional<NpyPlace>> find_message(std::string_view stream, std::size_t most_values);
/// Returns the numbers of the array as a picture. Precondition: two dimensions, neither of them empty.
[[nodiscard]] cv::Mat1f picture_at(std::string_view stream, const NpyPlace& place);

/// First message of a stream.
struct MessageRead {
  std::optional<NpyMessage> message;  ///< empty: more bytes are needed
  std::size_t bytes = 0;              ///< size of the message
};
/// Reads the first message of a stream. Errors: `integrity` (no .npy array, column order, more than `most_values`
/// values, a type other than <f4, <f8, |u1, |i1, <u2, <i2, <u4, <i4, |b1).
[[nodiscard]] Result<MessageRead> read_message(std::string_view stream, std::size_t most_values);

}  // namespace todbench
