// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/recording/recording_backend.h"

#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <string_view>

#include "acquisition/base/safe_file.h"
#include "acquisition/base/try.h"
#include "acquisition/core/camera_id.h"
#include "acquisition/recording/file_content.h"
#include "acquisition/recording/flir_seq.h"
#include "acquisition/recording/frame_stream.h"
#include "acquisition/recording/plausible_values.h"
#include "acquisition/recording/raw_recording.h"
#include "acquisition/recording/tiff_stack.h"

namespace todbench {
namespace {

/// Words that stand for numbers in a query.
struct QueryWord {
  std::string_view key, word;
  double value;
};
constexpr std::array query_words{QueryWord{"byte_order", "little", 0}, QueryWord{"byte_order", "big", 1},
                                 QueryWord{"signed", "no", 0},         QueryWord{"signed", "yes", 1},
                                 QueryWord{"unit", "counts", 0},       QueryWord{"unit", "kelvin", 1},
                                 QueryWord{"unit", "celsius", 2}};

/// The number of a word; empty for a key without words. Error: another word.
Result<std::optional<double>> number_of_word(std::string_view key, std::string_view word) {
  std::string expected;
  for (const QueryWord& known : query_words) {
    if (known.key != key) continue;
    if (known.word == word) return std::optional(known.value);
    expected += (expected.empty() ? "" : " or ") + std::string(known.word);
  }
  if (expected.empty()) return std::optional<double>();
  return fail(ErrorCode::invalid_input,
              std::string(key) + " must be " + expected + ", not '" + std::string(word) + "'");
}

/// key -> value of "width=160&height=120".
Result<std::map<std::string, double>> parsed_query(const std::string& query) {
  std::map<std::string, double> values;
  for (std::size_t begin = 0; begin < query.size();) {
    const std::size_t end = std::min(query.find('&', begin), query.size());
    const std::string item = query.substr(begin, end - begin);
    begin = end + 1;
    const std::size_t equals = item.find('=');
    const std::string key = item.substr(0, equals);
    const std::string word = equals == std::string::npos ? "" : item.substr(equals + 1);
    TODBENCH_TRY(const auto named, number_of_word(key, word));
    double value = named.value_or(0);
    const char* last = word.data() + word.size();
    const bool number = !word.empty() && (named || std::from_chars(word.data(), last, value).ptr == last);
    if (!number) return fail(ErrorCode::invalid_input, "'" + item + "' is not KEY=NUMBER");
    if (!values.emplace(key, value).second) return fail(ErrorCode::invalid_input, key + " is stated twice");
  }
  return values;
}

/// What a query states about a raw or a TIFF file.
struct StatedFormat {
  RawRecordingFormat raw;
  bool states_samples = false;  ///< byte order or sign
  bool states_sign = false;
  std::optional<ValueUnit> unit{};
};

Result<StatedFormat> stated_format(std::map<std::string, double> values) {
  const auto take = [&](const char* key, double otherwise) {
    const auto node = values.extract(key);
    return node.empty() ? otherwise : node.mapped();
  };
  StatedFormat stated;
  RawRecordingFormat& format = stated.raw;
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
  if (!calibrated && values.contains("offset_k"))
    return fail(ErrorCode::invalid_input, "offset_k is stated without kelvin_per_count");
  const double kelvin_per_count = take("kelvin_per_count", 0);
  const double offset_k = take("offset_k", 0);
  stated.states_sign = values.contains("signed");
  stated.states_samples = values.contains("byte_order") || stated.states_sign;
  if (take("byte_order", 0) != 0) format.byte_order = RawByteOrder::big;
  if (take("signed", 0) != 0) format.sign = RawSign::with;
  if (values.contains("unit")) stated.unit = static_cast<ValueUnit>(static_cast<int>(take("unit", 0)));
  if (!values.empty()) return fail(ErrorCode::invalid_input, "unknown key " + values.begin()->first);
  if (calibrated) {
    const auto scale = RadiometricScale::linear({kelvin_per_count, offset_k});
    if (!scale) return fail(ErrorCode::invalid_input, scale.error().message);
    format.scale = *scale;
  }
  return stated;
}

/// The sentence for a file of unknown content without a stated geometry: its name may promise a format.
std::string no_format(const std::filesystem::path& path, const FileContent& content) {
  const bool empty = content.start.empty();
  return path.string() + ": " +
         (empty ? "the file is empty"
                : "its content is none of the formats that this program reads (it begins with the bytes " +
                      content.start +
                      "; the name of the file is not decisive). If it is a raw recording, state its width and height "
                      "in pixels: ?width=640&height=480");
}

Result<Recording> checked(const std::filesystem::path& path, Result<Recording> recording, const KnownValues& known) {
  if (!recording) return recording;
  if (auto plausible = check_values(*recording, known); !plausible) return fail(path.string(), plausible.error());
  return recording;
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
    return fail(ErrorCode::not_found, path.string() + ": " + no_file_reason(path));
  const FileContent content = folder ? FileContent{FileKind::tiff} : content_of_file(path);
  const bool own_format = content.kind == FileKind::frame_stream || content.kind == FileKind::flir;
  if (!query.empty() && own_format)
    return fail(ErrorCode::invalid_input, path.string() + ": the file contains its format; remove '?" + query + "'");
  if (content.kind == FileKind::frame_stream) {
    TODBENCH_TRY(auto stream, open_frame_stream(path));
    return std::move(stream.recording);
  }
  if (content.kind == FileKind::flir) return checked(path, open_flir_seq(path), {KnownValues::Sign::of_camera});
  if (content.kind == FileKind::foreign) {
    return fail(ErrorCode::invalid_input,
                path.string() + ": the file is " + content.name + ", which this program does not read as a recording");
  }
  const auto values = parsed_query(query);
  if (!values) return fail(path.string(), values.error());
  const auto stated = stated_format(*values);
  if (!stated) return fail(path.string(), stated.error());
  const RawRecordingFormat& format = stated->raw;
  if (content.kind == FileKind::unknown) {
    if (format.width == 0 && format.height == 0) return fail(ErrorCode::invalid_input, no_format(path, content));
    if (stated->unit) return fail(ErrorCode::invalid_input, path.string() + ": raw values are counts; remove unit");
    const bool with_sign = format.sign == RawSign::with;
    const auto sign = with_sign             ? KnownValues::Sign::stated_signed
                      : stated->states_sign ? KnownValues::Sign::stated_unsigned
                                            : KnownValues::Sign::assumed_unsigned;
    return checked(path, open_raw_recording(path, format), {sign, with_sign});
  }
  if (format.width != 0 || format.height != 0)
    return fail(ErrorCode::invalid_input,
                path.string() + ": a TIFF file contains its width and height; do not state them");
  if (stated->states_samples)
    return fail(ErrorCode::invalid_input,
                path.string() + ": a TIFF file contains byte order and sign; do not state them");
  auto stack = open_tiff_stack(path, {format.significant_bits, format.frame_rate_hz, format.scale, stated->unit});
  const bool with_sign =
      stack && stack->info.settings.contains("Counts") && stated->unit.value_or(ValueUnit::counts) == ValueUnit::counts;
  return checked(path, std::move(stack), {KnownValues::Sign::in_file, with_sign, stated->unit});
}

std::unique_ptr<CameraBackend> recording_backend() {
  return std::make_unique<RecordingBackend>();
}

}  // namespace todbench
