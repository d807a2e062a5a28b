// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/module/npy_message.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <utility>

#include "acquisition/base/npy_header.h"
#include "acquisition/base/safe_text.h"
#include "acquisition/base/try.h"

namespace todbench {
namespace {

static_assert(std::endian::native == std::endian::little);
constexpr std::size_t longest_header = 65535;

template <typename T, typename To>
void convert(const char* bytes, std::size_t count, To* to) {
  for (std::size_t i = 0; i < count; ++i) {
    T value;
    std::memcpy(&value, bytes + i * sizeof value, sizeof value);
    to[i] = static_cast<To>(value);
  }
}

struct Type {
  std::string_view name;
  std::size_t bytes;
  void (*as_doubles)(const char* bytes, std::size_t count, double* to);
  void (*as_floats)(const char* bytes, std::size_t count, float* to);
};
template <typename T>
constexpr Type type_of(std::string_view name) {
  return {name, sizeof(T), convert<T, double>, convert<T, float>};
}
constexpr std::array types{type_of<float>("<f4"),        type_of<double>("<f8"),        type_of<std::uint8_t>("|u1"),
                           type_of<std::int8_t>("|i1"),  type_of<std::uint8_t>("|b1"),  type_of<std::uint16_t>("<u2"),
                           type_of<std::int16_t>("<i2"), type_of<std::uint32_t>("<u4"), type_of<std::int32_t>("<i4")};

/// Text after 'KEY': in the header's dictionary, up to `end`.
std::string_view entry_of(std::string_view header, std::string_view key, char end) {
  const auto place = header.find(key);
  if (place == std::string_view::npos) return {};
  const auto rest = header.substr(place + key.size());
  return rest.substr(0, rest.find(end));
}

/// Parses "2, 3" or "4," as numbers.
std::optional<std::vector<std::size_t>> shape_from(std::string_view text) {
  std::vector<std::size_t> shape;
  while (true) {
    while (!text.empty() && (text.front() == ' ' || text.front() == ',')) text.remove_prefix(1);
    if (text.empty()) return shape;
    std::size_t extent = 0;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), extent);
    if (problem != std::errc() || shape.size() > 4) return std::nullopt;
    shape.push_back(extent);
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  }
}

tl::unexpected<Error> wrong(const std::string& sentence) {
  return fail(ErrorCode::integrity, "the module's answer " + sentence);
}

}  // namespace

std::string to_message(const cv::Mat1f& picture) {
  std::string bytes = npy_header("<f4", fmt::format("{}, {}", picture.rows, picture.cols));
  bytes.reserve(bytes.size() + picture.total() * sizeof(float));
  for (int row = 0; row < picture.rows; ++row)
    bytes.append(reinterpret_cast<const char*>(picture.ptr(row)),
                 static_cast<std::size_t>(picture.cols) * sizeof(float));
  return bytes;
}

std::string to_message(const std::vector<double>& numbers) {
  std::string bytes = npy_header("<f8", fmt::format("{},", numbers.size()));
  bytes.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double));
  return bytes;
}

std::string to_message(std::string_view text) {
  return npy_header("|u1", fmt::format("{},", text.size())) + std::string(text);
}

Result<std::optional<NpyPlace>> find_message(std::string_view stream, std::size_t most_values) {
  const auto begins = stream.substr(0, npy_magic.size());
  if (!npy_magic.starts_with(begins))
    return wrong("is not a .npy array: it begins with '" + one_line(std::string(begins)) + "'");
  const std::optional<NpyPlace> not_yet;
  if (stream.size() < 12) return not_yet;
  const auto byte = [&](std::size_t i) { return static_cast<std::size_t>(static_cast<unsigned char>(stream[i])); };
  const std::size_t version = byte(6);
  if (version < 1 || version > 3) return wrong(fmt::format("has version {} of .npy, expected 1 to 3", version));
  const std::size_t length =
      version == 1 ? byte(8) | byte(9) << 8 : byte(8) | byte(9) << 8 | byte(10) << 16 | byte(11) << 24;
  const std::size_t begin = version == 1 ? 10 : 12;
  if (length > longest_header) return wrong("has a header that is too long");
  if (stream.size() < begin + length) return not_yet;
  const std::string_view header = stream.substr(begin, length);
  const std::string_view name = entry_of(header, "'descr': '", '\'');
  const auto* type = std::find_if(types.begin(), types.end(), [&](const Type& known) { return known.name == name; });
  if (type == types.end())
    return wrong("has the type '" + one_line(std::string(name)) + "', expected a number type, for example <f4");
  if (header.find("'fortran_order': False") == std::string_view::npos)
    return wrong("is stored by columns, expected by rows");
  const auto shape = shape_from(entry_of(header, "'shape': (", ')'));
  if (!shape) return wrong("has no shape");
  std::size_t count = 1;
  for (const std::size_t extent : *shape) {
    if (extent > most_values || count * extent > most_values)
      return wrong(fmt::format("has more than {} numbers", most_values));
    count *= extent;
  }
  const std::size_t bytes = begin + length + count * type->bytes;
  if (stream.size() < bytes) return not_yet;
  return std::optional(NpyPlace{*shape, static_cast<std::size_t>(type - types.begin()), begin + length, count, bytes});
}

cv::Mat1f picture_at(std::string_view stream, const NpyPlace& place) {
  cv::Mat1f picture(static_cast<int>(place.shape[0]), static_cast<int>(place.shape[1]));
  types[place.type].as_floats(stream.data() + place.numbers, place.count, picture.ptr<float>());
  return picture;
}

Result<MessageRead> read_message(std::string_view stream, std::size_t most_values) {
  TODBENCH_TRY(const auto place, find_message(stream, most_values));
  if (!place) return MessageRead{};
  NpyMessage message{place->shape, std::vector<double>(place->count)};
  types[place->type].as_doubles(stream.data() + place->numbers, place->count, message.values.data());
  return MessageRead{std::move(message), place->bytes};
}

}  // namespace todbench
