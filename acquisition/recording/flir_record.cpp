// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/recording/flir_record.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>

#include "acquisition/base/safe_file.h"
#include "acquisition/base/try.h"

namespace todbench {
namespace {

constexpr std::size_t header_bytes = 64;
constexpr std::size_t index_entry_bytes = 32;
constexpr std::size_t raw_header_bytes = 32;
constexpr std::size_t version_offset = 20;
/// Least length of the constants, up to the time; and the length up to the frame rate.
constexpr std::size_t camera_info_bytes = 0x390;
constexpr std::size_t camera_info_with_rate_bytes = 0x466;
/// Cameras round the length of compressed pixels up, and leave these bytes out at the end of the file.
constexpr std::uint64_t most_missing_bytes = 16;
constexpr std::uint16_t raw_data_type = 0x01;
constexpr std::uint16_t camera_info_type = 0x20;

/// Numbers in a section of the file. Reads beyond its end are zero; callers check sizes if zero would be a valid value.
class FlirFields {
 public:
  FlirFields(std::string_view bytes, bool big_endian) : bytes_(bytes), big_endian_(big_endian) {}

  [[nodiscard]] std::uint16_t u16(std::size_t at) const { return static_cast<std::uint16_t>(number(at, 2)); }
  [[nodiscard]] std::uint32_t u32(std::size_t at) const { return number(at, 4); }
  [[nodiscard]] std::int32_t i32(std::size_t at) const { return static_cast<std::int32_t>(number(at, 4)); }
  [[nodiscard]] double f32(std::size_t at) const { return std::bit_cast<float>(number(at, 4)); }
  [[nodiscard]] std::string text(std::size_t at, std::size_t length) const {
    if (at + length > bytes_.size()) return {};
    return {bytes_.data() + at, strnlen(bytes_.data() + at, length)};
  }

 private:
  [[nodiscard]] std::uint32_t number(std::size_t at, std::size_t length) const {
    if (at + length > bytes_.size()) return 0;
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < length; ++i) {
      const std::size_t byte = big_endian_ ? at + i : at + length - 1 - i;
      value = value << 8 | static_cast<unsigned char>(bytes_[byte]);
    }
    return value;
  }

  std::string_view bytes_;
  bool big_endian_;
};

/// A block of a record; offsets from the start of the bytes.
struct FlirBlock {
  std::uint16_t type = 0;
  std::uint64_t offset = 0, length = 0;
  bool cut_off = false;  ///< its last bytes are missing
};

tl::unexpected<Error> broken(const std::string& what) {
  return fail(ErrorCode::invalid_input, what);
}

/// Blocks of a hostile record may lie over each other or over its index, so that bytes are read with two meanings.
bool separate(std::vector<FlirBlock> blocks) {
  std::sort(blocks.begin(), blocks.end(), [](const FlirBlock& a, const FlirBlock& b) { return a.offset < b.offset; });
  const auto over = [](const FlirBlock& a, const FlirBlock& b) { return a.offset + a.length > b.offset; };
  return std::adjacent_find(blocks.begin(), blocks.end(), over) == blocks.end();
}

/// The version, 100 and a few, shows the byte order of a header and its index; empty if the version is unknown.
std::optional<bool> big_endian_header(std::string_view start) {
  const auto plausible = [](std::uint32_t version) { return version >= 100 && version < 200; };
  if (plausible(FlirFields(start, false).u32(version_offset))) return false;
  if (plausible(FlirFields(start, true).u32(version_offset))) return true;
  return std::nullopt;
}

/// The FFF header at `begin` and its index.
Result<std::vector<FlirBlock>> read_index(const FlirBytes& bytes, std::uint64_t begin) {
  const std::string where = "FFF record at byte " + std::to_string(begin);
  const std::string start = bytes.read(begin, header_bytes);
  if (start.size() < header_bytes || !is_flir_record(start)) return broken("no " + where);
  const auto big_endian = big_endian_header(start);
  if (!big_endian) return broken(where + " has an unknown version");
  const FlirFields header(start, *big_endian);
  const std::uint64_t index = begin + header.u32(24);
  const std::size_t count = header.u32(28);
  if (count > 1000 || index + count * index_entry_bytes > bytes.size())
    return broken(where + " is truncated in its index");
  const std::string table = bytes.read(index, count * index_entry_bytes);
  // Header and index are blocks, too: no other one may lie over them.
  std::vector<FlirBlock> blocks{{0, begin, header_bytes}, {0, index, table.size()}};
  for (std::size_t i = 0; i < count; ++i) {
    const FlirFields entry(std::string_view(table).substr(std::min(i * index_entry_bytes, table.size())), *big_endian);
    FlirBlock found{entry.u16(0), begin + entry.u32(12), entry.u32(16)};
    if (found.type == 0 || found.length == 0) continue;
    if (found.offset + found.length > bytes.size()) {
      const std::uint64_t missing = found.offset + found.length - bytes.size();
      if (found.type != raw_data_type || missing > most_missing_bytes || missing >= found.length)
        return broken(where + " points outside the file: the file is truncated");
      found.length -= missing;
      found.cut_off = true;
    }
    const bool second =
        std::any_of(blocks.begin(), blocks.end(), [&](const FlirBlock& block) { return block.type == found.type; });
    if (second && (found.type == raw_data_type || found.type == camera_info_type))
      return broken(where + " has two blocks of " + (found.type == raw_data_type ? "pixels" : "constants"));
    blocks.push_back(found);
  }
  if (!separate(blocks)) return broken(where + " has blocks that overlap");
  return blocks;
}

/// Both blocks begin with the number 2 (bytes per pixel), which shows their byte order.
std::optional<bool> big_endian_block(std::string_view start) {
  if (FlirFields(start, false).u16(0) == 2) return false;
  if (FlirFields(start, true).u16(0) == 2) return true;
  return std::nullopt;
}

Result<void> read_camera_info(const FlirBytes& bytes, const FlirBlock& block, FlirSeqFrame& frame) {
  const std::string start =
      bytes.read(block.offset, std::min<std::uint64_t>(block.length, camera_info_with_rate_bytes));
  const auto big_endian = big_endian_block(start);
  if (!big_endian) return broken("the camera constants have an unknown byte order");
  if (start.size() < camera_info_bytes) return broken("the camera constants are truncated");
  const FlirFields info(start, *big_endian);
  FlirCamera camera;
  camera.object = {info.f32(0x20), info.f32(0x24), info.f32(0x28), info.f32(0x2C),
                   info.f32(0x30), info.f32(0x34), info.f32(0x3C)};
  // Some cameras state the humidity in percent.
  if (camera.object.relative_humidity > 2) camera.object.relative_humidity /= 100;
  camera.planck = {info.f32(0x58), info.f32(0x30C), info.f32(0x5C), info.f32(0x60),
                   static_cast<double>(info.i32(0x308))};
  camera.range_high_k = info.f32(0x90);
  camera.range_low_k = info.f32(0x94);
  camera.model = info.text(0xD4, 32);
  camera.serial = info.text(0x104, 16);
  camera.software = info.text(0x114, 16);
  camera.lens = info.text(0x170, 32);
  camera.lens_serial = info.text(0x1A0, 16);
  camera.frame_rate_hz = info.u16(0x464);
  frame.raw_median = info.u16(0x338);
  // Seconds since 1970 and, in the low half of the next word, milliseconds.
  frame.device_time_ns =
      std::int64_t{info.u32(0x384)} * 1'000'000'000 + (info.u32(0x388) & 0xFFFFU) * std::int64_t{1'000'000};
  frame.camera = std::make_shared<const FlirCamera>(std::move(camera));
  return {};
}

FlirStorage storage_of(std::string_view pixels) {
  if (pixels.starts_with("\x89PNG\r\n\x1a\n")) return FlirStorage::png;
  return pixels.starts_with("\xff\xd8\xff") ? FlirStorage::jpeg_ls : FlirStorage::raw;
}

Result<void> read_raw_data(const FlirBytes& bytes, const FlirBlock& block, FlirSeqFrame& frame) {
  const std::string start = bytes.read(block.offset, std::min<std::uint64_t>(block.length, raw_header_bytes + 8));
  const auto big_endian = big_endian_block(start);
  if (!big_endian) return broken("the pixels have an unknown format");
  if (start.size() < raw_header_bytes) return broken("the description of the pixels is truncated");
  const FlirFields header(start, *big_endian);
  frame.width = header.u16(2);
  frame.height = header.u16(4);
  frame.big_endian = *big_endian;
  frame.pixel_offset = block.offset + raw_header_bytes;
  frame.pixel_bytes = block.length - raw_header_bytes;
  const std::uint64_t raw_bytes = std::uint64_t{2} * header.u16(2) * header.u16(4);
  if (raw_bytes == 0) return broken("the frame has no pixels");
  // Pixels that have the length of raw ones are raw, whatever their first bytes look like.
  if (frame.pixel_bytes == raw_bytes) return {};
  frame.storage = storage_of(std::string_view(start).substr(raw_header_bytes));
  const bool whole = !block.cut_off || bytes.read(bytes.size() - 2, 2) == "\xff\xd9";
  if (!whole) return broken("the pixels point outside the file: the file is truncated");
  if (frame.storage != FlirStorage::raw) return {};
  return broken("the pixels have an unknown compression or are truncated: " + std::to_string(frame.pixel_bytes) +
                " bytes for " + std::to_string(frame.width) + " x " + std::to_string(frame.height));
}

/// Whether another record begins in the record from `begin` to `end`, outside its pixels. An index that lies joins the
/// pixels of one frame to the time of another.
bool other_record_inside(const FlirBytes& bytes, std::uint64_t begin, std::uint64_t end, const FlirSeqFrame& frame) {
  constexpr std::size_t window = 65536;
  const auto found = [&](std::uint64_t from, std::uint64_t to) {
    for (std::uint64_t at = from; at < to; at += window - header_bytes) {
      if (holds_flir_record(bytes.read(at, static_cast<std::size_t>(std::min<std::uint64_t>(window, to - at)))))
        return true;
    }
    return false;
  };
  return found(begin + header_bytes, frame.pixel_offset) || found(frame.pixel_offset + frame.pixel_bytes, end);
}

}  // namespace

Result<FlirBytes> FlirBytes::of_file(const std::filesystem::path& path) {
  TODBENCH_TRY(const int descriptor, open_to_read(path));
  FlirBytes bytes;
  bytes.file_ = std::make_shared<const Descriptor>(descriptor);
  struct stat state {};
  if (::fstat(descriptor, &state) != 0 || state.st_size < 0)
    return fail(ErrorCode::io, path.string() + ": cannot be read");
  bytes.size_ = static_cast<std::uint64_t>(state.st_size);
  return bytes;
}

FlirBytes::FlirBytes(std::string memory)
    : memory_(std::make_shared<const std::string>(std::move(memory))), size_(memory_->size()) {}

std::string FlirBytes::read(std::uint64_t offset, std::size_t length) const {
  if (offset >= size_) return {};
  length = static_cast<std::size_t>(std::min<std::uint64_t>(length, size_ - offset));
  if (memory_) return memory_->substr(static_cast<std::size_t>(offset), length);
  std::string bytes(length, '\0');
  std::size_t done = 0;
  while (done < length) {
    const ssize_t got = ::pread(file_->get(), bytes.data() + done, length - done, static_cast<off_t>(offset + done));
    if (got <= 0) break;
    done += static_cast<std::size_t>(got);
  }
  bytes.resize(done);
  return bytes;
}

Result<RadiometricScale> planck_scale(const FlirPlanck& planck) {
  if (!(planck.r2 > 0)) return fail(ErrorCode::calibration, "the Planck constant R2 must be positive");
  return RadiometricScale::planck({planck.r1 / planck.r2, planck.b, planck.f, -planck.o});
}

bool is_flir_record(std::string_view start) {
  using namespace std::string_view_literals;
  return start.starts_with("FFF\0"sv) || start.starts_with("AFF\0"sv);
}

bool holds_flir_record(std::string_view bytes) {
  using namespace std::string_view_literals;
  // The first byte of a record may be an F, too, so the search is for the bytes that follow it.
  constexpr auto rest = "FF\0"sv;
  for (std::size_t at = bytes.find(rest, 1); at != std::string_view::npos; at = bytes.find(rest, at + 1)) {
    const std::string_view start = bytes.substr(at - 1, header_bytes);
    if (is_flir_record(start) && big_endian_header(start)) return true;
  }
  return false;
}

Result<FlirRecord> read_flir_record(const FlirBytes& bytes, std::uint64_t begin) {
  TODBENCH_TRY(const auto blocks, read_index(bytes, begin));
  FlirRecord record;
  for (const FlirBlock& block : blocks) {
    Result<void> read;
    if (block.type == camera_info_type) read = read_camera_info(bytes, block, record.frame);
    if (block.type == raw_data_type) read = read_raw_data(bytes, block, record.frame);
    if (!read) return tl::unexpected(read.error());
    record.end = std::max(record.end, block.offset + block.length);
  }
  if (record.frame.width == 0) return broken("the record has no pixels");
  if (other_record_inside(bytes, begin, record.end, record.frame))
    return broken("FFF record at byte " + std::to_string(begin) + " contains another record");
  return record;
}

}  // namespace todbench
