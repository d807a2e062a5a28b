// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures in NumPy's format: a header that is a Python literal, then the values.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "acquisition/base/npy_header.h"
#include "acquisition/base/try.h"
#include "acquisition/recording/picture_file.h"

namespace todbench {
namespace {

static_assert(std::endian::native == std::endian::little, "values are swapped where a file says big-endian");

constexpr int longest_side = 65535;

/// The entries of the header, as text.
struct Header {
  std::string descr, order;
  std::vector<std::int64_t> shape;
  std::size_t data_at = 0;
};

tl::unexpected<Error> broken() {
  return fail(ErrorCode::invalid_input, "the header of the .npy file is broken");
}

/// The value of 'KEY' as text, up to its end.
std::optional<std::string_view> value_of(std::string_view header, std::string_view key) {
  for (const char quote : {'\'', '"'}) {
    const std::size_t at = header.find(quote + std::string(key) + quote);
    if (at == std::string_view::npos) continue;
    std::string_view rest = header.substr(at + key.size() + 2);
    const std::size_t colon = rest.find_first_not_of(" \t");
    if (colon == std::string_view::npos || rest[colon] != ':') continue;
    rest.remove_prefix(colon + 1);
    rest.remove_prefix(std::min(rest.find_first_not_of(" \t"), rest.size()));
    return rest;
  }
  return std::nullopt;
}

std::optional<std::vector<std::int64_t>> shape_of(std::string_view text) {
  if (!text.starts_with('(')) return std::nullopt;
  const std::size_t end = text.find(')');
  if (end == std::string_view::npos) return std::nullopt;
  text = text.substr(1, end - 1);
  std::vector<std::int64_t> shape;
  while (!text.empty()) {
    text.remove_prefix(std::min(text.find_first_not_of(" \t,"), text.size()));
    if (text.empty()) break;
    std::int64_t side = 0;
    const auto [stop, problem] = std::from_chars(text.data(), text.data() + text.size(), side);
    if (problem != std::errc() || shape.size() > 8) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(stop - text.data()));
    if (text.starts_with('L')) text.remove_prefix(1);
    shape.push_back(side);
  }
  return shape;
}

Result<Header> header_of(std::string_view bytes) {
  if (bytes.size() < 12) return broken();
  const auto byte = [&](std::size_t i) { return static_cast<std::size_t>(static_cast<unsigned char>(bytes[i])); };
  const std::size_t version = byte(6);
  if (version < 1 || version > 3) return broken();
  const std::size_t begin = version == 1 ? 10 : 12;
  const std::size_t length =
      version == 1 ? byte(8) + (byte(9) << 8) : byte(8) + (byte(9) << 8) + (byte(10) << 16) + (byte(11) << 24);
  if (length > bytes.size() - begin) return broken();
  const std::string_view text = bytes.substr(begin, length);
  const auto descr = value_of(text, "descr"), order = value_of(text, "fortran_order"), shape = value_of(text, "shape");
  if (!descr || !order || !shape || descr->empty()) return broken();
  Header header;
  if (descr->front() != '\'' && descr->front() != '"')
    return fail(ErrorCode::invalid_input, "the .npy file holds records, expected plain numbers");
  const std::size_t end = descr->find(descr->front(), 1);
  auto sides = shape_of(*shape);
  if (end == std::string_view::npos || !sides) return broken();
  header.descr = descr->substr(1, end - 1);
  header.order = order->starts_with("True") ? "F" : order->starts_with("False") ? "C" : "";
  if (header.order.empty()) return broken();
  header.shape = *std::move(sides);
  header.data_at = begin + length;
  return header;
}

template <typename Value>
double value_at(const char* bytes, bool swapped) {
  std::array<char, sizeof(Value)> raw{};
  std::memcpy(raw.data(), bytes, sizeof(Value));
  if (swapped) std::reverse(raw.begin(), raw.end());
  Value value{};
  std::memcpy(&value, raw.data(), sizeof(Value));
  return static_cast<double>(value);
}

/// A type of values and its decoder.
struct ValueType {
  std::string_view name;
  std::size_t size;
  double (*read)(const char* bytes, bool swapped);
  double low, high;
  bool whole;
};

template <typename Value>
constexpr ValueType type_of(std::string_view name) {
  return {name,
          sizeof(Value),
          value_at<Value>,
          static_cast<double>(std::numeric_limits<Value>::lowest()),
          static_cast<double>(std::numeric_limits<Value>::max()),
          std::numeric_limits<Value>::is_integer};
}

constexpr std::array value_types{type_of<std::uint8_t>("u1"),  type_of<std::uint16_t>("u2"),
                                 type_of<std::uint32_t>("u4"), type_of<std::uint64_t>("u8"),
                                 type_of<std::int8_t>("i1"),   type_of<std::int16_t>("i2"),
                                 type_of<std::int32_t>("i4"),  type_of<std::int64_t>("i8"),
                                 type_of<float>("f4"),         type_of<double>("f8")};

}  // namespace

Result<PictureFile> parse_npy(std::string_view bytes) {
  if (!bytes.starts_with(npy_magic)) return fail(ErrorCode::invalid_input, "not a .npy file");
  TODBENCH_TRY(const auto header, header_of(bytes));
  const std::string_view descr = header.descr;
  const auto type = std::find_if(value_types.begin(), value_types.end(), [&](const ValueType& known) {
    return descr.size() == 3 && std::string_view("<>|=").find(descr[0]) != std::string_view::npos &&
           descr.substr(1) == known.name;
  });
  if (type == value_types.end()) {
    return fail(ErrorCode::invalid_input, "the .npy file holds values of type '" + header.descr.substr(0, 20) +
                                              "', expected integers or floating point of 32 or 64 bits");
  }
  if (header.shape.size() != 2) {
    return fail(ErrorCode::invalid_input, "the .npy file has " + std::to_string(header.shape.size()) +
                                              " dimensions, expected 2: rows and columns");
  }
  const std::int64_t rows = header.shape[0], columns = header.shape[1];
  if (rows < 1 || columns < 1 || rows > longest_side || columns > longest_side)
    return fail(ErrorCode::invalid_input, "the picture in the .npy file is empty or too large");
  const std::size_t values = static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns);
  if (bytes.size() - header.data_at != values * type->size)
    return fail(ErrorCode::invalid_input, "the number of values in the .npy file differs from its header");
  PictureFile file;
  file.picture.create(static_cast<int>(rows), static_cast<int>(columns));
  const bool swapped = descr[0] == '>', fortran = header.order == "F";
  const char* at = bytes.data() + header.data_at;
  for (std::size_t i = 0; i < values; ++i, at += type->size) {
    const auto wide = static_cast<std::size_t>(columns), high = static_cast<std::size_t>(rows);
    const std::size_t row = fortran ? i % high : i / wide, column = fortran ? i / high : i % wide;
    file.picture(static_cast<int>(row), static_cast<int>(column)) = type->read(at, swapped);
  }
  if (type->whole) file.counts = {type->low, type->high};
  return file;
}

}  // namespace todbench
