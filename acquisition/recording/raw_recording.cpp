// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/recording/raw_recording.h"

#include <bit>
#include <fstream>
#include <system_error>
#include <utility>

#include "acquisition/base/try.h"
#include "acquisition/core/camera_id.h"
#include "acquisition/recording/tiff_values.h"

namespace todbench {
namespace {

static_assert(std::endian::native == std::endian::little, "frames are read without swapping bytes");

Result<RecordedFrame> read_raw_frame(std::ifstream& file, const RawRecordingFormat& format, std::uint64_t index) {
  RecordedFrame frame;
  frame.counts.create(format.height, format.width);
  const auto bytes = static_cast<std::streamsize>(frame.counts.total() * frame.counts.elemSize());
  file.clear();
  file.seekg(static_cast<std::streamoff>(index) * bytes);
  file.read(reinterpret_cast<char*>(frame.counts.data), bytes);
  if (file.gcount() != bytes) return fail(ErrorCode::io, "the file became shorter after it was opened");
  if (format.byte_order == RawByteOrder::big) {
    for (auto& count : frame.counts) count = static_cast<ushort>(count << 8 | count >> 8);
  }
  // Two's complement plus 32768: the highest bit changes.
  if (format.sign == RawSign::with) cv::bitwise_xor(frame.counts, cv::Scalar(0x8000), frame.counts);
  return frame;
}

}  // namespace

Result<Recording> open_raw_recording(const std::filesystem::path& path, const RawRecordingFormat& format) {
  const std::string name = path.string();
  if (format.width < 1 || format.height < 1 || format.width > 65536 || format.height > 65536) {
    return fail(ErrorCode::invalid_input,
                name + ": state the width and height of a raw recording in pixels, 1 ... 65536");
  }
  if (format.significant_bits < 1 || format.significant_bits > 16) {
    return fail(ErrorCode::invalid_input, name + ": significant bits must be 1 ... 16");
  }
  std::error_code error;
  const std::uint64_t size = std::filesystem::file_size(path, error);
  auto file = std::make_shared<std::ifstream>(path, std::ios::binary);
  if (error || !*file) return fail(ErrorCode::io, name + ": " + (error ? error.message() : "cannot be read"));
  const std::uint64_t frame_bytes =
      2 * static_cast<std::uint64_t>(format.width) * static_cast<std::uint64_t>(format.height);
  if (size == 0 || size % frame_bytes != 0) {
    return fail(ErrorCode::invalid_input, name + ": " + std::to_string(size) + " bytes are not a whole number of " +
                                              std::to_string(format.width) + " x " + std::to_string(format.height) +
                                              " frames of " + std::to_string(frame_bytes) + " bytes");
  }
  Recording recording;
  recording.info.id = camera_id(camera_scheme::file, name);
  recording.info.model = path.filename().string();
  recording.info.transport = "recording";
  recording.info.width = format.width;
  recording.info.height = format.height;
  recording.info.pixel_format = "Mono16";
  recording.info.significant_bits = format.significant_bits;
  recording.info.frame_rate_hz = format.frame_rate_hz;
  const ValueCounts conversion{format.sign == RawSign::with ? -32768.0 : 0.0};
  TODBENCH_TRY(recording.info.scale, conversion.scale(format.scale));
  recording.info.settings = {{"Width", std::to_string(format.width)}, {"Height", std::to_string(format.height)}};
  if (format.byte_order == RawByteOrder::big) recording.info.settings["ByteOrder"] = "big-endian";
  if (auto relation = conversion.describe(); !relation.empty()) recording.info.settings["Counts"] = std::move(relation);
  recording.frame_count = size / frame_bytes;
  recording.read = [file, format](std::uint64_t index) { return read_raw_frame(*file, format, index); };
  return recording;
}

}  // namespace todbench
