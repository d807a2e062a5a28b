// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/recording/flir_seq.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <tuple>

#include "acquisition/base/try.h"
#include "acquisition/core/camera_id.h"

namespace todbench {
namespace {

constexpr std::size_t header_bytes = 64;
constexpr std::size_t index_entry_bytes = 32;
constexpr std::size_t raw_header_bytes = 32;
constexpr std::uint16_t raw_data_type = 0x01;
constexpr std::uint16_t camera_info_type = 0x20;

/// Numbers in a section of the file. Reads beyond its end are zero; callers check sizes if zero would be a valid value.
class Bytes {
 public:
  Bytes(const std::vector<char>& file, std::size_t begin, std::size_t size, bool big_endian)
      : data_(file.data() + std::min(begin, file.size())),
        size_(std::min(size, file.size() - std::min(begin, file.size()))),
        big_endian_(big_endian) {}

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::uint16_t u16(std::size_t at) const { return static_cast<std::uint16_t>(number(at, 2)); }
  [[nodiscard]] std::uint32_t u32(std::size_t at) const { return number(at, 4); }
  [[nodiscard]] std::int32_t i32(std::size_t at) const { return static_cast<std::int32_t>(number(at, 4)); }
  [[nodiscard]] double f32(std::size_t at) const { return std::bit_cast<float>(number(at, 4)); }
  [[nodiscard]] std::string text(std::size_t at, std::size_t length) const {
    if (at + length > size_) return {};
    return {data_ + at, strnlen(data_ + at, length)};
  }

 private:
  [[nodiscard]] std::uint32_t number(std::size_t at, std::size_t length) const {
    if (at + length > size_) return 0;
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < length; ++i) {
      const std::size_t byte = big_endian_ ? at + i : at + length - 1 - i;
      value = value << 8 | static_cast<unsigned char>(data_[byte]);
    }
    return value;
  }

  const char* data_;
  std::size_t size_;
  bool big_endian_;
};

struct IndexEntry {
  std::uint16_t type = 0;
  std::size_t offset = 0, length = 0;  ///< offset from the start of the file
};

struct Record {
  std::vector<IndexEntry> entries;
  std::size_t end = 0;
};

tl::unexpected<Error> broken(const std::string& what) {
  return fail(ErrorCode::invalid_input, what);
}

/// The FFF header at `begin` and its index.
Result<Record> read_record(const std::vector<char>& file, std::size_t begin) {
  const std::string where = "FFF record at byte " + std::to_string(begin);
  if (begin + header_bytes > file.size() || std::memcmp(file.data() + begin, "FFF\0", 4) != 0) {
    return broken("no " + where);
  }
  // The version, 100 and a few, shows the byte order of the header and the index.
  const Bytes little(file, begin, header_bytes, false);
  const Bytes big(file, begin, header_bytes, true);
  const auto plausible = [](std::uint32_t version) { return version >= 100 && version < 200; };
  if (!plausible(little.u32(20)) && !plausible(big.u32(20))) return broken(where + " has an unknown version");
  const bool big_endian = !plausible(little.u32(20));
  const Bytes& header = big_endian ? big : little;
  const std::size_t index = header.u32(24);
  const std::size_t count = header.u32(28);
  if (count > 1000 || begin + index + count * index_entry_bytes > file.size()) {
    return broken(where + " is truncated in its index");
  }
  Record record;
  record.end = begin + index + count * index_entry_bytes;
  for (std::size_t i = 0; i < count; ++i) {
    const Bytes entry(file, begin + index + i * index_entry_bytes, index_entry_bytes, big_endian);
    const IndexEntry found{entry.u16(0), begin + entry.u32(12), entry.u32(16)};
    if (found.type == 0) continue;
    if (found.offset + found.length > file.size())
      return broken(where + " points outside the file: the file is truncated");
    record.entries.push_back(found);
    record.end = std::max(record.end, found.offset + found.length);
  }
  return record;
}

/// Both blocks begin with the number 2 (bytes per pixel), which shows their byte order.
std::optional<bool> big_endian_block(const std::vector<char>& file, const IndexEntry& entry) {
  if (Bytes(file, entry.offset, entry.length, false).u16(0) == 2) return false;
  if (Bytes(file, entry.offset, entry.length, true).u16(0) == 2) return true;
  return std::nullopt;
}

Result<void> read_camera_info(const std::vector<char>& file, const IndexEntry& entry, FlirSeqFrame& frame) {
  const auto big_endian = big_endian_block(file, entry);
  if (!big_endian) return broken("the camera constants have an unknown byte order");
  const Bytes info(file, entry.offset, entry.length, *big_endian);
  if (info.size() < 0x390) return broken("the camera constants are truncated");
  frame.object = {info.f32(0x20), info.f32(0x24), info.f32(0x28), info.f32(0x2C),
                  info.f32(0x30), info.f32(0x34), info.f32(0x3C)};
  frame.planck = {info.f32(0x58), info.f32(0x30C), info.f32(0x5C), info.f32(0x60),
                  static_cast<double>(info.i32(0x308))};
  frame.camera_model = info.text(0xD4, 32);
  frame.camera_serial = info.text(0x104, 16);
  frame.camera_software = info.text(0x114, 16);
  // Seconds since 1970 and, in the low half of the next word, milliseconds.
  frame.device_time_ns =
      std::int64_t{info.u32(0x384)} * 1'000'000'000 + (info.u32(0x388) & 0xFFFFU) * std::int64_t{1'000'000};
  return {};
}

Result<void> read_raw_data(const std::vector<char>& file, const IndexEntry& entry, FlirSeqFrame& frame) {
  const auto big_endian = big_endian_block(file, entry);
  if (!big_endian) return broken("the pixels have an unknown format");
  const Bytes header(file, entry.offset, entry.length, *big_endian);
  frame.width = header.u16(2);
  frame.height = header.u16(4);
  frame.big_endian = *big_endian;
  frame.pixel_offset = entry.offset + raw_header_bytes;
  const std::size_t pixels = static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height);
  if (pixels == 0) return broken("the frame has no pixels");
  if (header.size() != raw_header_bytes + 2 * pixels) {
    return broken("the pixels are compressed or truncated: " + std::to_string(header.size()) + " bytes for " +
                  std::to_string(frame.width) + " x " + std::to_string(frame.height));
  }
  return {};
}

Result<FlirSeqFrame> read_frame_description(const std::vector<char>& file, const Record& record) {
  FlirSeqFrame frame;
  for (const auto& entry : record.entries) {
    Result<void> read;
    if (entry.type == camera_info_type) read = read_camera_info(file, entry, frame);
    if (entry.type == raw_data_type) read = read_raw_data(file, entry, frame);
    if (!read) return tl::unexpected(read.error());
  }
  if (frame.width == 0) return broken("the record has no pixels");
  return frame;
}

bool same_camera(const FlirSeqFrame& a, const FlirSeqFrame& b) {
  const auto key = [](const FlirSeqFrame& f) {
    return std::tie(f.width, f.height, f.planck.r1, f.planck.r2, f.planck.b, f.planck.f, f.planck.o, f.camera_serial);
  };
  return key(a) == key(b);
}

Result<RecordedFrame> read_pixels(std::ifstream& file, const FlirSeqFrame& frame) {
  RecordedFrame recorded;
  recorded.device_time_ns = frame.device_time_ns;
  recorded.counts.create(frame.height, frame.width);
  const auto bytes = static_cast<std::streamsize>(recorded.counts.total() * recorded.counts.elemSize());
  file.clear();
  file.seekg(static_cast<std::streamoff>(frame.pixel_offset));
  file.read(reinterpret_cast<char*>(recorded.counts.data), bytes);
  if (file.gcount() != bytes) return fail(ErrorCode::io, "the file became shorter after it was opened");
  if (frame.big_endian) {
    for (auto& count : recorded.counts) count = static_cast<ushort>(count << 8 | count >> 8);
  }
  return recorded;
}

std::string text(double value) {
  std::string digits = std::to_string(value);
  digits.erase(digits.find_last_not_of('0') + 1);
  return digits.ends_with('.') ? digits + "0" : digits;
}

SourceInfo source_info(const std::filesystem::path& path, const FlirSeqFrame& first, const RadiometricScale& scale) {
  SourceInfo info;
  info.id = camera_id(camera_scheme::file, path.string());
  info.vendor = "FLIR";
  info.model = first.camera_model;
  info.serial = first.camera_serial;
  info.firmware = first.camera_software;
  info.transport = "recording";
  info.width = first.width;
  info.height = first.height;
  info.pixel_format = "Mono16";
  info.scale = scale;
  info.settings = {{"PlanckR1", text(first.planck.r1)},
                   {"PlanckR2", text(first.planck.r2)},
                   {"PlanckB", text(first.planck.b)},
                   {"PlanckF", text(first.planck.f)},
                   {"PlanckO", text(first.planck.o)},
                   {"ObjectEmissivity", text(first.object.emissivity)},
                   {"ObjectDistance", text(first.object.distance_m)},
                   {"ReflectedTemperature", text(first.object.reflected_temperature_k)},
                   {"AtmosphericTemperature", text(first.object.atmospheric_temperature_k)},
                   {"RelativeHumidity", text(first.object.relative_humidity)}};
  return info;
}

}  // namespace

Result<RadiometricScale> planck_scale(const FlirPlanck& planck) {
  if (!(planck.r2 > 0)) return fail(ErrorCode::calibration, "the Planck constant R2 must be positive");
  return RadiometricScale::planck({planck.r1 / planck.r2, planck.b, planck.f, -planck.o});
}

Result<std::vector<FlirSeqFrame>> read_flir_seq(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) return fail(ErrorCode::io, path.string() + ": cannot be read");
  const std::vector<char> file{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  std::vector<FlirSeqFrame> frames;
  for (std::size_t begin = 0; begin < file.size();) {
    const auto record = read_record(file, begin);
    if (!record) return fail(path.string(), record.error());
    auto frame = read_frame_description(file, *record);
    if (!frame) return fail(path.string() + ": frame " + std::to_string(frames.size()), frame.error());
    frames.push_back(std::move(*frame));
    begin = record->end;
  }
  if (frames.empty()) return fail(ErrorCode::invalid_input, path.string() + ": the file is empty");
  return frames;
}

Result<Recording> open_flir_seq(const std::filesystem::path& path) {
  TODBENCH_TRY(auto frames, read_flir_seq(path));
  const bool uniform = std::all_of(frames.begin(), frames.end(),
                                   [&](const FlirSeqFrame& frame) { return same_camera(frames.front(), frame); });
  if (!uniform) {
    return fail(ErrorCode::invalid_input,
                path.string() + ": the picture size or the calibration changes within the file");
  }
  const auto scale = planck_scale(frames.front().planck);
  if (!scale) return fail(path.string(), scale.error());
  auto file = std::make_shared<std::ifstream>(path, std::ios::binary);
  if (!*file) return fail(ErrorCode::io, path.string() + ": cannot be read");
  Recording recording;
  recording.info = source_info(path, frames.front(), *scale);
  recording.frame_count = frames.size();
  recording.read = [file, all = std::move(frames)](std::uint64_t index) { return read_pixels(*file, all[index]); };
  return recording;
}

}  // namespace todbench
