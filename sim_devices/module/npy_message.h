// Messages between the bench and a module: arrays in NumPy's .npy format, little-endian, one after the other.
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"

namespace todbench {

/// An array as it came: numbers of any type that a module may answer with, as doubles.
struct NpyMessage {
  std::vector<std::size_t> shape;
  std::vector<double> values;  ///< last index fastest
};

/// A picture as <f4, two dimensions, rows first.
[[nodiscard]] std::string to_message(const cv::Mat1f& picture);
/// Numbers as <f8, one dimension.
[[nodiscard]] std::string to_message(const std::vector<double>& numbers);
/// A text as |u1, one dimension: the header that is sent first.
[[nodiscard]] std::string to_message(std::string_view text);

/// Where an array stands in a stream.
struct NpyPlace {
  std::vector<std::size_t> shape;
  std::size_t type = 0;                ///< of the table in npy_message.cpp
  std::size_t numbers = 0, count = 0;  ///< first byte of the numbers, how many there are
  std::size_t bytes = 0;               ///< of the whole message
};
/// The array at the beginning of a stream once all of it is there; nothing while bytes are missing. Errors as
/// read_message().
[[nodiscard]] Result<std::optional<NpyPlace>> find_message(std::string_view stream, std::size_t most_values);
/// Its numbers as a picture. Precondition: two dimensions, neither empty.
[[nodiscard]] cv::Mat1f picture_at(std::string_view stream, const NpyPlace& place);

/// What stands at the beginning of a stream.
struct MessageRead {
  std::optional<NpyMessage> message;  ///< nothing: more bytes are needed
  std::size_t bytes = 0;              ///< of the message
};
/// `integrity` in one sentence: no .npy array, a type other than <f4, <f8, |u1, |i1, <u2, <i2, <u4, <i4, |b1, order of
/// columns, more than `most_values`.
[[nodiscard]] Result<MessageRead> read_message(std::string_view stream, std::size_t most_values);

}  // namespace todbench
