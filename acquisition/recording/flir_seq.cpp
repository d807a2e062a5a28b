// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/recording/flir_seq.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>
#include <utility>

#include "acquisition/base/try.h"
#include "acquisition/compression/compressed_picture.h"
#include "acquisition/core/byte_order.h"
#include "acquisition/core/camera_id.h"
#include "acquisition/recording/flir_jpeg.h"

namespace todbench {
namespace {

/// JPEG-LS and PNG of noise are a little longer than the noise; a longer block is not read.
constexpr std::uint64_t most_bytes_per_pixel = 4;
constexpr std::uint64_t most_extra_bytes = 65536;

void swap_bytes(cv::Mat1w& counts) {
  for (auto& count : counts) count = static_cast<ushort>(count << 8 | count >> 8);
}

bool is_jpeg(std::string_view start) {
  return start.starts_with("\xff\xd8\xff");
}

/// The bytes that hold the records: those of the file, or those of the segments of a JPEG picture.
Result<FlirBytes> records_of(const std::filesystem::path& path) {
  TODBENCH_TRY(auto file, FlirBytes::of_file(path));
  if (!is_jpeg(file.read(0, 3))) return file;
  TODBENCH_TRY(auto record, flir_record_of_jpeg(file));
  return FlirBytes(std::move(record));
}

/// The start of the next record from `at`. Programs fill the gap between records with zeros; other bytes are damage.
Result<std::uint64_t> next_record(const FlirBytes& bytes, std::uint64_t at) {
  constexpr std::size_t window = 65536;
  const std::uint64_t first = at;
  while (at < bytes.size()) {
    const std::string part = bytes.read(at, window);
    const std::size_t used = part.find_first_not_of('\0');
    if (part.empty()) break;
    if (used != std::string::npos) {
      at += used;
      if (at != first && !is_flir_record(bytes.read(at, 4)))
        return fail(ErrorCode::invalid_input, "no FFF record at byte " + std::to_string(at));
      return at;
    }
    at += part.size();
  }
  return bytes.size();
}

Result<std::vector<FlirSeqFrame>> frames_in(const FlirBytes& bytes) {
  std::vector<FlirSeqFrame> frames;
  for (std::uint64_t at = 0;;) {
    TODBENCH_TRY(at, next_record(bytes, at));
    if (at >= bytes.size()) break;
    auto record = read_flir_record(bytes, at);
    if (!record) return fail("frame " + std::to_string(frames.size()), record.error());
    FlirSeqFrame& frame = record->frame;
    // One description serves all frames with the same constants: a long recording has many frames of one camera.
    if (!frames.empty()) {
      const auto& before = frames.back().camera;
      if (!frame.camera || (before && frame.camera->planck == before->planck && frame.camera->serial == before->serial))
        frame.camera = before;
    }
    frames.push_back(std::move(frame));
    at = record->end;
  }
  if (frames.empty()) return fail(ErrorCode::invalid_input, "the file is empty");
  return frames;
}

bool same_camera(const FlirSeqFrame& a, const FlirSeqFrame& b) {
  return a.width == b.width && a.height == b.height && a.camera == b.camera;
}

/// Reads the bytes of the pixels.
Result<std::string> stored_bytes(const FlirBytes& bytes, const FlirSeqFrame& frame) {
  const std::uint64_t pixels = static_cast<std::uint64_t>(frame.width) * static_cast<std::uint64_t>(frame.height);
  if (frame.storage != FlirStorage::raw && frame.pixel_bytes > most_bytes_per_pixel * pixels + most_extra_bytes)
    return fail(ErrorCode::invalid_input, "the compressed picture is longer than its pixels");
  const std::string stored = bytes.read(frame.pixel_offset, static_cast<std::size_t>(frame.pixel_bytes));
  if (stored.size() != frame.pixel_bytes) return fail(ErrorCode::io, "the file became shorter after it was opened");
  return stored;
}

/// Reads the pixels as the file stores them.
Result<cv::Mat1w> stored_pixels(const FlirBytes& bytes, const FlirSeqFrame& frame) {
  const cv::Size size(frame.width, frame.height);
  TODBENCH_TRY(const std::string stored, stored_bytes(bytes, frame));
  if (frame.storage == FlirStorage::png) return decode_png(stored, size);
  if (frame.storage == FlirStorage::jpeg_ls) return decode_jpeg_ls(stored, size);
  cv::Mat1w counts(size);
  std::memcpy(counts.data, stored.data(), stored.size());
  if (frame.big_endian) swap_bytes(counts);
  return counts;
}

/// Whether the bytes of a PNG are exchanged, as many FLIR cameras write them: by the median that the camera states, or
/// else by the smoothness of the picture.
bool is_swapped(const cv::Mat1w& counts, int stated_median) {
  if (stated_median > 0) {
    std::vector<ushort> values(counts.begin(), counts.end());
    const auto median = [&] {
      const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
      std::nth_element(values.begin(), middle, values.end());
      return static_cast<int>(*middle);
    };
    const int as_stored = std::abs(median() - stated_median);
    for (auto& value : values) value = static_cast<ushort>(value << 8 | value >> 8);
    const int swapped = std::abs(median() - stated_median);
    if (as_stored != swapped) return swapped < as_stored;
  }
  return byte_order_evidence(counts, {}).verdict == ByteOrderVerdict::swapped;
}

Result<RecordedFrame> read_pixels(const FlirBytes& bytes, const FlirSeqFrame& frame, bool swapped) {
  TODBENCH_TRY(auto counts, stored_pixels(bytes, frame));
  if (swapped) swap_bytes(counts);
  RecordedFrame recorded;
  recorded.counts = std::move(counts);
  recorded.device_time_ns = frame.device_time_ns;
  return recorded;
}

/// The shortest text of a number of single precision, as the file has it.
std::string text(double value) {
  return fmt::format("{}", static_cast<float>(value));
}

std::string storage_text(const FlirSeqFrame& frame, bool swapped) {
  if (frame.storage == FlirStorage::jpeg_ls) return "JPEG-LS";
  if (frame.storage == FlirStorage::png) return swapped ? "PNG with exchanged bytes" : "PNG";
  return frame.big_endian ? "raw, big-endian" : "raw, little-endian";
}

/// Date and time in UTC; empty if the camera states none.
std::string date_text(std::int64_t device_time_ns) {
  constexpr std::int64_t second_ns = 1'000'000'000;
  if (device_time_ns < second_ns) return {};
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(static_cast<std::time_t>(device_time_ns / second_ns)),
                     device_time_ns % second_ns / 1'000'000);
}

/// States that object parameters other than those of a black body are not in the temperatures; empty if all are
/// neutral.
std::string object_note(const FlirObjectParameters& object) {
  std::string not_neutral;
  const auto add = [&](const char* name, double value) {
    not_neutral += (not_neutral.empty() ? "" : ", ") + std::string(name) + " = " + text(value);
  };
  // Cameras store factors in steps of 0.001.
  if (!(std::abs(object.emissivity - 1) <= 1e-3)) add("ObjectEmissivity", object.emissivity);
  if (object.distance_m > 0) add("ObjectDistance", object.distance_m);
  if (!(std::abs(object.window_transmission - 1) <= 1e-3)) add("IRWindowTransmission", object.window_transmission);
  if (not_neutral.empty()) return {};
  return "The temperatures are those of a black body in front of the lens: the Planck constants in the file are "
         "applied, its object parameters are not (" +
         not_neutral + ").";
}

SourceInfo source_info(const std::filesystem::path& path, const FlirSeqFrame& first, const RadiometricScale& scale) {
  const FlirCamera& camera = *first.camera;
  SourceInfo info;
  info.id = camera_id(camera_scheme::file, path.string());
  info.vendor = "FLIR";
  info.model = camera.model;
  info.serial = camera.serial;
  info.firmware = camera.software;
  info.transport = "recording";
  info.width = first.width;
  info.height = first.height;
  info.pixel_format = "Mono16";
  info.frame_rate_hz = camera.frame_rate_hz;
  info.scale = scale;
  info.settings = {{"PlanckR1", text(camera.planck.r1)},
                   {"PlanckR2", text(camera.planck.r2)},
                   {"PlanckB", text(camera.planck.b)},
                   {"PlanckF", text(camera.planck.f)},
                   {"PlanckO", text(camera.planck.o)},
                   {"ObjectEmissivity", text(camera.object.emissivity)},
                   {"ObjectDistance", text(camera.object.distance_m)},
                   {"ReflectedTemperature", text(camera.object.reflected_temperature_k)},
                   {"AtmosphericTemperature", text(camera.object.atmospheric_temperature_k)},
                   {"RelativeHumidity", text(camera.object.relative_humidity)},
                   {"IRWindowTemperature", text(camera.object.window_temperature_k)},
                   {"IRWindowTransmission", text(camera.object.window_transmission)},
                   {"CameraTemperatureRangeMin", text(camera.range_low_k)},
                   {"CameraTemperatureRangeMax", text(camera.range_high_k)},
                   {"LensModel", camera.lens},
                   {"LensSerialNumber", camera.lens_serial},
                   {"DateTimeOriginal", date_text(first.device_time_ns)}};
  if (auto note = object_note(camera.object); !note.empty()) info.warnings.push_back(std::move(note));
  return info;
}

/// States the largest error that the compression of any frame permits. A damaged frame is reported when it is read.
Result<void> note_losses(const FlirBytes& bytes, std::span<const FlirSeqFrame> frames, SourceInfo& info) {
  // The header of a JPEG-LS picture precedes its pixels.
  constexpr std::uint64_t longest_header = 64 * 1024;
  std::optional<int> largest;
  for (const FlirSeqFrame& frame : frames) {
    if (frame.storage != FlirStorage::jpeg_ls) continue;
    const auto error = largest_jpeg_ls_error(
        bytes.read(frame.pixel_offset, static_cast<std::size_t>(std::min(frame.pixel_bytes, longest_header))));
    if (error)
      largest = std::max(*error, largest.value_or(0));
    else if (&frame == &frames.front())
      return tl::unexpected(error.error());
  }
  if (!largest) return {};
  info.settings["LargestCompressionError"] = std::to_string(*largest);
  if (*largest > 0)
    info.warnings.push_back("The camera compressed the pixels with losses: a count may be off by " +
                            std::to_string(*largest) + ". Noise in this file is not the noise of the camera.");
  return {};
}

}  // namespace

bool is_flir_file(std::string_view start) {
  return is_flir_record(start) || is_jpeg(start);
}

Result<Recording> open_flir_seq(const std::filesystem::path& path) {
  const auto bytes = records_of(path);
  if (!bytes) return fail(path.string(), bytes.error());
  auto frames = frames_in(*bytes);
  if (!frames) return fail(path.string(), frames.error());
  const FlirSeqFrame& first = frames->front();
  const bool uniform =
      std::all_of(frames->begin(), frames->end(), [&](const FlirSeqFrame& frame) { return same_camera(first, frame); });
  if (!uniform) {
    return fail(ErrorCode::invalid_input,
                path.string() + ": the picture size or the calibration changes within the file");
  }
  if (!first.camera)
    return fail(ErrorCode::invalid_input, path.string() + ": the file does not contain the constants of the camera");
  const auto scale = planck_scale(first.camera->planck);
  if (!scale) return fail(path.string(), scale.error());
  Recording recording;
  recording.info = source_info(path, first, *scale);
  bool swapped = false;
  if (auto noted = note_losses(*bytes, *frames, recording.info); !noted) return fail(path.string(), noted.error());
  if (first.storage == FlirStorage::png) {
    const auto counts = stored_pixels(*bytes, first);
    if (!counts) return fail(path.string(), counts.error());
    swapped = is_swapped(*counts, first.camera->raw_median);
  }
  recording.info.settings["RawThermalImageType"] = storage_text(first, swapped);
  recording.frame_count = frames->size();
  recording.read = [bytes = *bytes, all = *std::move(frames), swapped](std::uint64_t index) {
    return read_pixels(bytes, all[index], swapped);
  };
  return recording;
}

}  // namespace todbench
