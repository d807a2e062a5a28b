#include "sim_devices/module/npy_message.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>

#include "acquisition/core/safe_text.h"

namespace todbench {
namespace {

static_assert(std::endian::native == std::endian::little);
constexpr std::string_view magic("\x93NUMPY", 6);
constexpr std::size_t longest_header = 65535;

std::string with_header(std::string_view type, const std::string& shape) {
  std::string header = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}", type, shape);
  // Magic, version, length and header end together at a multiple of 64, with a line end.
  constexpr std::size_t before = 10, alignment = 64;
  while ((before + header.size() + 1) % alignment != 0) header += ' ';
  header += '\n';
  std::string bytes(magic);
  bytes += std::string("\x01\x00", 2);
  bytes += static_cast<char>(header.size() & 0xff);
  bytes += static_cast<char>(header.size() >> 8);
  return bytes + header;
}

template <typename T>
std::vector<double> numbers_at(const char* bytes, std::size_t count) {
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    T value;
    std::memcpy(&value, bytes + i * sizeof value, sizeof value);
    values[i] = static_cast<double>(value);
  }
  return values;
}

struct Type {
  std::string_view name;
  std::size_t bytes;
  std::vector<double> (*read)(const char* bytes, std::size_t count);
};
constexpr std::array types{
    Type{"<f4", 4, numbers_at<float>},        Type{"<f8", 8, numbers_at<double>},
    Type{"|u1", 1, numbers_at<std::uint8_t>}, Type{"|i1", 1, numbers_at<std::int8_t>},
    Type{"|b1", 1, numbers_at<std::uint8_t>}, Type{"<u2", 2, numbers_at<std::uint16_t>},
    Type{"<i2", 2, numbers_at<std::int16_t>}, Type{"<u4", 4, numbers_at<std::uint32_t>},
    Type{"<i4", 4, numbers_at<std::int32_t>},
};

/// What stands behind 'KEY': in the header's dictionary, up to `end`.
std::string_view entry_of(std::string_view header, std::string_view key, char end) {
  const auto place = header.find(key);
  if (place == std::string_view::npos) return {};
  const auto rest = header.substr(place + key.size());
  return rest.substr(0, rest.find(end));
}

/// "2, 3" or "4," as numbers.
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
  return fail(ErrorCode::integrity, "the module's answer: " + sentence);
}

}  // namespace

std::string to_message(const cv::Mat1f& picture) {
  std::string bytes = with_header("<f4", fmt::format("{}, {}", picture.rows, picture.cols));
  for (int row = 0; row < picture.rows; ++row)
    bytes.append(reinterpret_cast<const char*>(picture.ptr(row)),
                 static_cast<std::size_t>(picture.cols) * sizeof(float));
  return bytes;
}

std::string to_message(std::string_view text) {
  return with_header("|u1", fmt::format("{},", text.size())) + std::string(text);
}

Result<MessageRead> read_message(std::string_view stream, std::size_t most_values) {
  const auto begins = stream.substr(0, magic.size());
  if (!magic.starts_with(begins))
    return wrong("is no .npy array, it begins with '" + one_line(std::string(begins)) + "'");
  if (stream.size() < 12) return MessageRead{};
  const auto byte = [&](std::size_t i) { return static_cast<std::size_t>(static_cast<unsigned char>(stream[i])); };
  const std::size_t version = byte(6);
  if (version < 1 || version > 3) return wrong(fmt::format("is of version {} of .npy", version));
  const std::size_t length =
      version == 1 ? byte(8) | byte(9) << 8 : byte(8) | byte(9) << 8 | byte(10) << 16 | byte(11) << 24;
  const std::size_t begin = version == 1 ? 10 : 12;
  if (length > longest_header) return wrong("has too long a header");
  if (stream.size() < begin + length) return MessageRead{};
  const std::string_view header = stream.substr(begin, length);
  const std::string_view name = entry_of(header, "'descr': '", '\'');
  const Type* type = nullptr;
  for (const auto& known : types) type = known.name == name ? &known : type;
  if (type == nullptr) return wrong("has the type '" + one_line(std::string(name)) + "', expected one as <f4");
  if (header.find("'fortran_order': False") == std::string_view::npos) return wrong("has columns first, expected rows");
  const auto shape = shape_from(entry_of(header, "'shape': (", ')'));
  if (!shape) return wrong("has no shape");
  std::size_t count = 1;
  for (const std::size_t extent : *shape) {
    if (extent > most_values || count * extent > most_values)
      return wrong(fmt::format("has more than {} numbers", most_values));
    count *= extent;
  }
  const std::size_t bytes = begin + length + count * type->bytes;
  if (stream.size() < bytes) return MessageRead{};
  NpyMessage message{*shape, type->read(stream.data() + begin + length, count)};
  return MessageRead{std::move(message), bytes};
}

}  // namespace todbench
