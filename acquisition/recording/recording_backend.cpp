#include "acquisition/recording/recording_backend.h"

#include <charconv>
#include <filesystem>
#include <map>
#include <optional>

#include "acquisition/recording/flir_seq.h"
#include "acquisition/recording/raw_recording.h"

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
    if (!values.emplace(key, value).second) return fail(ErrorCode::invalid_input, key + " is given twice");
  }
  return values;
}

Result<RawRecordingFormat> raw_format(std::map<std::string, double> values) {
  const auto take = [&](const char* key, double otherwise) {
    const auto node = values.extract(key);
    return node.empty() ? otherwise : node.mapped();
  };
  RawRecordingFormat format;
  format.width = static_cast<int>(take("width", 0));
  format.height = static_cast<int>(take("height", 0));
  format.significant_bits = static_cast<int>(take("bits", 16));
  format.frame_rate_hz = take("frame_rate_hz", 0);
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
  [[nodiscard]] std::string scheme() const override { return "file"; }
  [[nodiscard]] Result<std::vector<CameraEntry>> list() override { return std::vector<CameraEntry>(); }
  [[nodiscard]] Result<std::unique_ptr<FrameSource>> open(const std::string& id) override {
    if (!id.starts_with("file:")) return fail(ErrorCode::invalid_input, "'" + id + "' does not begin with file:");
    const std::string rest = id.substr(5);
    const std::size_t mark = rest.find('?');
    const std::filesystem::path path = rest.substr(0, mark);
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) {
      return fail(ErrorCode::not_found, path.string() + ": no such file");
    }
    auto recording = path.extension() == ".seq" ? open_flir_seq(path) : open_raw(path, mark, rest);
    if (!recording) return tl::unexpected(recording.error());
    recording->info.id = id;
    return recorded_source(std::move(*recording));
  }

 private:
  [[nodiscard]] static Result<Recording> open_raw(const std::filesystem::path& path, std::size_t mark,
                                                  const std::string& rest) {
    const auto values = parsed_query(mark == std::string::npos ? "" : rest.substr(mark + 1));
    if (!values) return fail(path.string(), values.error());
    const auto format = raw_format(*values);
    if (!format) return fail(path.string(), format.error());
    return open_raw_recording(path, *format);
  }
};

}  // namespace

std::unique_ptr<CameraBackend> recording_backend() {
  return std::make_unique<RecordingBackend>();
}

}  // namespace todbench
