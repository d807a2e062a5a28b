// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/recording/recording_backend.h"

#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>

#include "acquisition/base/try.h"
#include "acquisition/core/camera_id.h"
#include "acquisition/recording/flir_seq.h"
#include "acquisition/recording/frame_stream.h"
#include "acquisition/recording/raw_recording.h"
#include "acquisition/recording/tiff_stack.h"

namespace todbench {
namespace {

/// key -> value of "width=160&height=120".
Result<std::map<std::string, double>> parsed_query(const std::string& query) {
  std::map<std::string, double> values;
  for (std::size_t begin = 0; begin < query.size();) {
    const std::size_t end = std::min(query.find('&', begin), query.size());
    const std::string item = query.substr(begin, end - begin);
    begin = end + 1;
    const std::size_t equals = item.find('=');
    const std::string key = item.substr(0, equals);
    double value = 0;
    const char* last = item.data() + item.size();
    const bool number = equals != std::string::npos && equals + 1 < item.size() &&
                        std::from_chars(item.data() + equals + 1, last, value).ptr == last;
    if (!number) return fail(ErrorCode::invalid_input, "'" + item + "' is not KEY=NUMBER");
    if (!values.emplace(key, value).second) return fail(ErrorCode::invalid_input, key + " is stated twice");
  }
  return values;
}

Result<RawRecordingFormat> raw_format(std::map<std::string, double> values) {
  const auto take = [&](const char* key, double otherwise) {
    const auto node = values.extract(key);
    return node.empty() ? otherwise : node.mapped();
  };
  RawRecordingFormat format;
  // A number that is not an integer or out of range becomes -1, which is refused later.
  const auto whole = [&](const char* key, double otherwise) {
    const double value = take(key, otherwise);
    return value >= 0 && value <= 65536 && value == std::floor(value) ? static_cast<int>(value) : -1;
  };
  format.width = whole("width", 0);
  format.height = whole("height", 0);
  format.significant_bits = whole("bits", 16);
  format.frame_rate_hz = take("frame_rate_hz", 0);
  if (!std::isfinite(format.frame_rate_hz) || format.frame_rate_hz < 0)
    return fail(ErrorCode::invalid_input, "frame_rate_hz must be at least 0");
  const bool calibrated = values.contains("kelvin_per_count");
  const double kelvin_per_count = take("kelvin_per_count", 0);
  const double offset_k = take("offset_k", 0);
  if (!values.empty()) return fail(ErrorCode::invalid_input, "unknown key " + values.begin()->first);
  if (calibrated) {
    const auto scale = RadiometricScale::linear({kelvin_per_count, offset_k});
    if (!scale) return fail(ErrorCode::invalid_input, scale.error().message);
    format.scale = *scale;
  }
  return format;
}

class RecordingBackend : public CameraBackend {
 public:
  [[nodiscard]] std::string scheme() const override { return std::string(camera_scheme::file); }
  [[nodiscard]] Result<std::vector<CameraEntry>> list() override { return std::vector<CameraEntry>(); }
  [[nodiscard]] Result<std::unique_ptr<FrameSource>> open(const std::string& id) override {
    const auto name = camera_name(id, camera_scheme::file);
    if (!name) return fail(ErrorCode::invalid_input, "'" + id + "' does not begin with file:");
    const std::size_t mark = name->find('?');
    const std::filesystem::path path = name->substr(0, mark);
    TODBENCH_TRY(auto recording, open_recording(path, mark == std::string::npos ? "" : name->substr(mark + 1)));
    recording.info.id = id;
    return recorded_source(std::move(recording));
  }
};

}  // namespace

Result<Recording> open_recording(const std::filesystem::path& path, const std::string& query) {
  std::error_code error;
  const bool folder = std::filesystem::is_directory(path, error);
  if (!folder && !std::filesystem::is_regular_file(path, error))
    return fail(ErrorCode::not_found, path.string() + ": no such file");
  const bool is_stream = !folder && is_frame_stream(path);
  if (!query.empty() && !folder && (is_stream || path.extension() == ".seq"))
    return fail(ErrorCode::invalid_input, path.string() + ": the file contains its format; remove '?" + query + "'");
  if (is_stream) {
    TODBENCH_TRY(auto stream, open_frame_stream(path));
    return std::move(stream.recording);
  }
  if (path.extension() == ".seq") return open_flir_seq(path);
  const auto values = parsed_query(query);
  if (!values) return fail(path.string(), values.error());
  const auto format = raw_format(*values);
  if (!format) return fail(path.string(), format.error());
  if (!folder && !has_tiff_name(path)) return open_raw_recording(path, *format);
  if (format->width != 0 || format->height != 0)
    return fail(ErrorCode::invalid_input,
                path.string() + ": a TIFF file contains its width and height; do not state them");
  return open_tiff_stack(path, {format->significant_bits, format->frame_rate_hz, format->scale});
}

std::unique_ptr<CameraBackend> recording_backend() {
  return std::make_unique<RecordingBackend>();
}

}  // namespace todbench
