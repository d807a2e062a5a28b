// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/recording/stream_header.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

namespace todbench {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* schema = "todbench-recording-1";

Json scale_json(const RadiometricScale& scale) {
  const auto& any = scale.parameters();
  if (const auto* linear = std::get_if<LinearScale>(&any)) {
    return {{"kind", "linear"}, {"kelvin_per_count", linear->kelvin_per_count}, {"offset_k", linear->offset_k}};
  }
  if (const auto* table = std::get_if<TableScale>(&any)) {
    return {{"kind", "table"}, {"counts", table->counts}, {"temperature_k", table->temperature_k}};
  }
  if (const auto* planck = std::get_if<PlanckScale>(&any)) {
    return {{"kind", "planck"}, {"r", planck->r}, {"b", planck->b}, {"f", planck->f}, {"o", planck->o}};
  }
  return {{"kind", "uncalibrated"}};
}

/// Returns the rate; 0 (unknown) for a rate that is not finite or not positive, because JSON has no number for these.
double known_rate(double frame_rate_hz) {
  return std::isfinite(frame_rate_hz) && frame_rate_hz > 0 ? frame_rate_hz : 0;
}

/// Reads keys of one object and keeps the first error, a missing key or a wrong type.
class Reader {
 public:
  explicit Reader(const Json& object) : object_(object) {}

  std::string text(const char* key) {
    const Json* value = find(key);
    if (value == nullptr || !value->is_string()) return refuse(key), std::string();
    return value->get<std::string>();
  }
  double number(const char* key) {
    const Json* value = find(key);
    if (value == nullptr || !value->is_number()) return refuse(key), 0.0;
    return value->get<double>();
  }
  std::int64_t whole(const char* key, std::int64_t low, std::int64_t high) {
    const Json* value = find(key);
    if (value == nullptr || !value->is_number_integer()) return refuse(key), low;
    const auto number = value->get<std::int64_t>();
    if (number < low || number > high) return refuse(key), low;
    return number;
  }
  std::vector<double> numbers(const char* key) {
    std::vector<double> out;
    const Json* value = find(key);
    if (value == nullptr || !value->is_array()) return refuse(key), out;
    for (const Json& item : *value) {
      if (!item.is_number()) return refuse(key), out;
      out.push_back(item.get<double>());
    }
    return out;
  }
  std::vector<std::string> texts(const char* key) {
    std::vector<std::string> out;
    const Json* value = find(key);
    if (value == nullptr || !value->is_array()) return refuse(key), out;
    for (const Json& item : *value) {
      if (!item.is_string()) return refuse(key), out;
      out.push_back(item.get<std::string>());
    }
    return out;
  }
  std::map<std::string, std::string> table(const char* key) {
    std::map<std::string, std::string> out;
    const Json* value = find(key);
    if (value == nullptr || !value->is_object()) return refuse(key), out;
    for (const auto& [name, item] : value->items()) {
      if (!item.is_string()) return refuse(key), out;
      out[name] = item.get<std::string>();
    }
    return out;
  }
  const Json* find(const char* key) {
    if (!object_.is_object()) return nullptr;
    const auto found = object_.find(key);
    return found == object_.end() ? nullptr : &*found;
  }
  void refuse(const char* key) {
    if (!problem_) problem_ = key;
  }
  [[nodiscard]] const std::optional<std::string>& problem() const { return problem_; }

 private:
  const Json& object_;
  std::optional<std::string> problem_;
};

Result<RadiometricScale> scale_from(const Json& json) {
  Reader reader(json);
  const std::string kind = reader.text("kind");
  Result<RadiometricScale> scale = RadiometricScale();
  if (kind == "linear") {
    scale = RadiometricScale::linear(
        {.kelvin_per_count = reader.number("kelvin_per_count"), .offset_k = reader.number("offset_k")});
  } else if (kind == "table") {
    scale =
        RadiometricScale::table({.counts = reader.numbers("counts"), .temperature_k = reader.numbers("temperature_k")});
  } else if (kind == "planck") {
    scale = RadiometricScale::planck(
        {.r = reader.number("r"), .b = reader.number("b"), .f = reader.number("f"), .o = reader.number("o")});
  } else if (kind != "uncalibrated") {
    return fail(ErrorCode::invalid_input, "scale: the kind is unknown");
  }
  if (reader.problem())
    return fail(ErrorCode::invalid_input, "scale: key '" + *reader.problem() + "' is missing or wrong");
  if (!scale) return fail(ErrorCode::invalid_input, "scale: " + scale.error().message);
  return scale;
}

}  // namespace

std::string stream_header_text(const StreamHeader& header) {
  const SourceInfo& info = header.info;
  Json json{{"schema", schema},
            {"created_utc", header.created_utc},
            {"created_host_ns", header.created_host_ns},
            {"camera",
             {{"id", info.id},
              {"vendor", info.vendor},
              {"model", info.model},
              {"serial", info.serial},
              {"firmware", info.firmware},
              {"transport", info.transport},
              {"width", info.width},
              {"height", info.height},
              {"pixel_format", info.pixel_format},
              {"significant_bits", info.significant_bits},
              {"frame_rate_hz", known_rate(info.frame_rate_hz)},
              {"scale", scale_json(info.scale)},
              {"settings", Json::object()},
              {"warnings", info.warnings}}},
            {"annotations", Json::object()}};
  for (const auto& [key, value] : info.settings) json["camera"]["settings"][key] = value;
  for (const auto& [key, value] : header.annotations) json["annotations"][key] = value;
  // Text of a device need not be UTF-8; invalid bytes become replacement characters.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Result<StreamHeader> parse_stream_header(std::string_view text) {
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) return fail(ErrorCode::invalid_input, "the header is not JSON");
  Reader reader(json);
  if (reader.text("schema") != schema) return fail(ErrorCode::invalid_input, "the header has an unknown schema");
  StreamHeader header;
  header.created_utc = reader.text("created_utc");
  header.created_host_ns = reader.whole("created_host_ns", 0, std::numeric_limits<std::int64_t>::max());
  header.annotations = reader.table("annotations");
  const Json* camera = reader.find("camera");
  if (camera == nullptr) reader.refuse("camera");
  if (reader.problem()) return fail(ErrorCode::invalid_input, "key '" + *reader.problem() + "' is missing or wrong");
  Reader of_camera(*camera);
  SourceInfo& info = header.info;
  info.id = of_camera.text("id");
  info.vendor = of_camera.text("vendor");
  info.model = of_camera.text("model");
  info.serial = of_camera.text("serial");
  info.firmware = of_camera.text("firmware");
  info.transport = of_camera.text("transport");
  info.width = static_cast<int>(of_camera.whole("width", 1, 65535));
  info.height = static_cast<int>(of_camera.whole("height", 1, 65535));
  info.pixel_format = of_camera.text("pixel_format");
  info.significant_bits = static_cast<int>(of_camera.whole("significant_bits", 1, 16));
  const Json* rate = of_camera.find("frame_rate_hz");
  if (rate == nullptr || (!rate->is_number() && !rate->is_null())) of_camera.refuse("frame_rate_hz");
  if (rate != nullptr && rate->is_number()) info.frame_rate_hz = known_rate(rate->get<double>());
  info.settings = of_camera.table("settings");
  info.warnings = of_camera.texts("warnings");
  const Json* scale = of_camera.find("scale");
  if (scale == nullptr) of_camera.refuse("scale");
  if (of_camera.problem()) {
    return fail(ErrorCode::invalid_input, "camera: key '" + *of_camera.problem() + "' is missing or wrong");
  }
  auto read = scale_from(*scale);
  if (!read) return fail("camera", read.error());
  info.scale = *std::move(read);
  return header;
}

}  // namespace todbench
