// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/recording/flir_seq.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <set>
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
    // One description serves all frames with the same settings: a long recording has many frames of one camera.
    if (!frames.empty()) {
      const auto& before = frames.back().camera;
      if (!frame.camera || (before && *frame.camera == *before)) frame.camera = before;
    }
    frames.push_back(std::move(frame));
    at = record->end;
  }
  if (frames.empty()) return fail(ErrorCode::invalid_input, "the file is empty");
  return frames;
}

/// Whether two frames have the same size and the same scale.
bool same_camera(const FlirSeqFrame& a, const FlirSeqFrame& b) {
  if (a.width != b.width || a.height != b.height) return false;
  if (!a.camera || !b.camera) return a.camera == b.camera;
  return a.camera->planck == b.camera->planck && a.camera->serial == b.camera->serial;
}

/// Reads the bytes of the pixels.
Result<std::string> stored_bytes(const FlirBytes& bytes, const FlirSeqFrame& frame) {
  const std::uint64_t pixels = static_cast<std::uint64_t>(frame.width) * static_cast<std::uint64_t>(frame.height);
  if (frame.storage != FlirStorage::raw && frame.pixel_bytes > most_bytes_per_pixel * pixels + most_extra_bytes)
    return fail(ErrorCode::invalid_input, "the compressed picture is longer than its pixels");
  const std::string stored = bytes.read(frame.pixel_offset, static_cast<std::size_t>(frame.pixel_bytes));
  if (stored.size() != frame.pixel_bytes) return fail(ErrorCode::io, "the file became shorter after it was opened");
  if (frame.storage != FlirStorage::raw && holds_flir_record(stored))
    return fail(ErrorCode::invalid_input, "the compressed picture contains another record");
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

/// Whether the bytes of a PNG are exchanged, by the median that the camera states for this frame. Empty if the median
/// does not decide.
std::optional<bool> swapped_by_median(const cv::Mat1w& counts, int stated_median) {
  if (stated_median <= 0) return std::nullopt;
  std::vector<ushort> values(counts.begin(), counts.end());
  const auto median = [&] {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return static_cast<int>(*middle);
  };
  const int as_stored = std::abs(median() - stated_median);
  for (auto& value : values) value = static_cast<ushort>(value << 8 | value >> 8);
  const int swapped = std::abs(median() - stated_median);
  if (as_stored == swapped) return std::nullopt;
  return swapped < as_stored;
}

/// Byte order of the PNG pictures of a file, as the first of them shows it: many FLIR cameras exchange the bytes. It
/// holds for the frames whose median does not decide. False without a PNG.
Result<bool> png_swapped(const FlirBytes& bytes, std::span<const FlirSeqFrame> frames) {
  const auto png = std::find_if(frames.begin(), frames.end(),
                                [](const FlirSeqFrame& frame) { return frame.storage == FlirStorage::png; });
  if (png == frames.end()) return false;
  TODBENCH_TRY(const auto counts, stored_pixels(bytes, *png));
  if (const auto decided = swapped_by_median(counts, png->raw_median)) return *decided;
  return byte_order_evidence(counts, {}).verdict == ByteOrderVerdict::swapped;
}

Result<RecordedFrame> read_pixels(const FlirBytes& bytes, const FlirSeqFrame& frame, bool swapped) {
  TODBENCH_TRY(auto counts, stored_pixels(bytes, frame));
  if (frame.storage == FlirStorage::png && swapped_by_median(counts, frame.raw_median).value_or(swapped))
    swap_bytes(counts);
  RecordedFrame recorded;
  recorded.counts = std::move(counts);
  recorded.device_time_ns = frame.device_time_ns;
  return recorded;
}

/// The shortest text of a number of single precision, as the file has it.
std::string text(double value) {
  return fmt::format("{}", static_cast<float>(value));
}

/// The storage formats of the frames, each once.
std::string storage_text(std::span<const FlirSeqFrame> frames, bool swapped) {
  const auto name = [&](const FlirSeqFrame& frame) -> std::string {
    if (frame.storage == FlirStorage::jpeg_ls) return "JPEG-LS";
    if (frame.storage == FlirStorage::png) return swapped ? "PNG with exchanged bytes" : "PNG";
    return frame.big_endian ? "raw, big-endian" : "raw, little-endian";
  };
  std::set<std::string> names;
  for (const FlirSeqFrame& frame : frames) names.insert(name(frame));
  return fmt::format("{}", fmt::join(names, "; "));
}

/// Date and time in UTC; empty if the camera states none.
std::string date_text(std::int64_t device_time_ns) {
  constexpr std::int64_t second_ns = 1'000'000'000;
  if (device_time_ns < second_ns) return {};
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(static_cast<std::time_t>(device_time_ns / second_ns)),
                     device_time_ns % second_ns / 1'000'000);
}

/// States the object parameters that are not those of a black body in front of the lens, with their values in all
/// frames; empty if all are neutral.
std::string object_note(std::span<const FlirSeqFrame> frames) {
  std::string not_neutral;
  const auto add = [&](const char* name, double FlirObjectParameters::*parameter, double neutral) {
    double low = frames.front().camera->object.*parameter, high = low;
    for (const FlirSeqFrame& frame : frames) {
      low = std::min(low, frame.camera->object.*parameter);
      high = std::max(high, frame.camera->object.*parameter);
    }
    // Cameras store factors in steps of 0.001.
    if (std::abs(low - neutral) <= 1e-3 && std::abs(high - neutral) <= 1e-3) return;
    not_neutral += (not_neutral.empty() ? "" : ", ") + std::string(name) + " = " + text(low);
    if (low != high) not_neutral += " to " + text(high);
  };
  add("ObjectEmissivity", &FlirObjectParameters::emissivity, 1);
  add("ObjectDistance", &FlirObjectParameters::distance_m, 0);
  add("IRWindowTransmission", &FlirObjectParameters::window_transmission, 1);
  if (not_neutral.empty()) return {};
  return "The temperatures are those of a black body in front of the lens: the Planck constants in the file are "
         "applied, its object parameters are not (" +
         not_neutral + ").";
}

/// States frames that are out of order or missing by the clock of the camera.
void note_times(std::span<const FlirSeqFrame> frames, SourceInfo& info) {
  std::vector<std::int64_t> steps_ns;
  for (std::size_t k = 1; k < frames.size(); ++k) {
    if (frames[k - 1].device_time_ns > 0 && frames[k].device_time_ns > 0)
      steps_ns.push_back(frames[k].device_time_ns - frames[k - 1].device_time_ns);
  }
  if (steps_ns.empty()) return;
  const auto back = std::count_if(steps_ns.begin(), steps_ns.end(), [](std::int64_t step) { return step < 0; });
  if (back > 0) {
    info.warnings.push_back(
        "The frames are not in the order of their exposures: the clock of the camera goes back at " +
        std::to_string(back) + " of " + std::to_string(steps_ns.size()) + " frames.");
    return;
  }
  std::sort(steps_ns.begin(), steps_ns.end());
  const std::int64_t usual_ns = steps_ns[steps_ns.size() / 2];
  // Without a frame, the step is twice the usual one.
  const auto gap = std::upper_bound(steps_ns.begin(), steps_ns.end(), usual_ns + usual_ns / 2);
  if (usual_ns == 0 || gap == steps_ns.end()) return;
  info.warnings.push_back(fmt::format(
      "Frames may be missing: the usual time between two frames is {:.3f} s, but {} of {} times are longer, up to "
      "{:.3f} s.",
      static_cast<double>(usual_ns) * 1e-9, steps_ns.end() - gap, steps_ns.size(),
      static_cast<double>(steps_ns.back()) * 1e-9));
}

SourceInfo source_info(const std::filesystem::path& path, std::span<const FlirSeqFrame> frames,
                       const RadiometricScale& scale) {
  const FlirSeqFrame& first = frames.front();
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
  if (auto note = object_note(frames); !note.empty()) info.warnings.push_back(std::move(note));
  note_times(frames, info);
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
  recording.info = source_info(path, *frames, *scale);
  if (auto noted = note_losses(*bytes, *frames, recording.info); !noted) return fail(path.string(), noted.error());
  const auto swapped = png_swapped(*bytes, *frames);
  if (!swapped) return fail(path.string(), swapped.error());
  recording.info.settings["RawThermalImageType"] = storage_text(*frames, *swapped);
  recording.frame_count = frames->size();
  recording.read = [bytes = *bytes, all = *std::move(frames), swapped = *swapped](std::uint64_t index) {
    return read_pixels(bytes, all[index], swapped);
  };
  return recording;
}

}  // namespace todbench
