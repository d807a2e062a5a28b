// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/aravis/genicam_features.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>

#include "acquisition/aravis/description_guard.h"
#include "acquisition/base/try.h"

namespace todbench {
namespace {

enum class Kind { integer, floating, enumeration, boolean, text, command };

std::optional<Kind> kind_of(ArvGcNode* node) {
  if (node == nullptr) return std::nullopt;
  if (ARV_IS_GC_ENUMERATION(node)) return Kind::enumeration;
  if (ARV_IS_GC_BOOLEAN(node)) return Kind::boolean;
  if (ARV_IS_GC_COMMAND(node)) return Kind::command;
  if (ARV_IS_GC_STRING(node)) return Kind::text;
  if (ARV_IS_GC_FLOAT(node)) return Kind::floating;
  if (ARV_IS_GC_INTEGER(node)) return Kind::integer;
  return std::nullopt;
}

Result<Kind> find(ArvDevice* device, const std::string& name) {
  const auto kind = kind_of(arv_device_get_feature(device, name.c_str()));
  if (!kind) return fail(ErrorCode::invalid_input, "the camera has no feature " + name);
  if (const auto fault = feature_fault(device, name)) {
    return fail(ErrorCode::invalid_input, "feature " + name + " is rejected: " + *fault);
  }
  GErrorSlot error;
  const bool available = arv_device_is_feature_available(device, name.c_str(), error.out()) != 0;
  if (error) return error.failure(ErrorCode::invalid_input, "looking up " + name);
  if (!available) return fail(ErrorCode::invalid_input, "feature " + name + " is not available now");
  return *kind;
}

template <typename Number>
std::string to_text(Number value) {
  char buffer[64];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  return {buffer, end};
}

template <typename Number>
std::optional<Number> parsed(const std::string& text) {
  Number value{};
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

tl::unexpected<Error> refused(const std::string& name, const std::string& value, const std::string& why) {
  return fail(ErrorCode::invalid_input, "setting " + name + "=" + value + ": " + why);
}

Result<void> set_integer(ArvDevice* device, const std::string& name, const std::string& value) {
  const auto number = parsed<gint64>(value);
  if (!number) return refused(name, value, "a whole number is expected");
  GErrorSlot error;
  gint64 low = 0;
  gint64 high = 0;
  arv_device_get_integer_feature_bounds(device, name.c_str(), &low, &high, error.out());
  // The bounds of some cameras cannot be read; these cameras check the value themselves.
  if (!error && (*number < low || *number > high)) {
    return refused(name, value, "outside " + to_text(low) + " ... " + to_text(high));
  }
  arv_device_set_integer_feature_value(device, name.c_str(), *number, error.out());
  if (error) return error.failure(ErrorCode::invalid_input, "setting " + name + "=" + value);
  return {};
}

Result<void> set_float(ArvDevice* device, const std::string& name, const std::string& value) {
  const auto number = parsed<double>(value);
  if (!number || !std::isfinite(*number)) return refused(name, value, "a number is expected");
  GErrorSlot error;
  double low = 0;
  double high = 0;
  arv_device_get_float_feature_bounds(device, name.c_str(), &low, &high, error.out());
  if (!error && (*number < low || *number > high)) {
    return refused(name, value, "outside " + to_text(low) + " ... " + to_text(high));
  }
  arv_device_set_float_feature_value(device, name.c_str(), *number, error.out());
  if (error) return error.failure(ErrorCode::invalid_input, "setting " + name + "=" + value);
  return {};
}

Result<void> set_enumeration(ArvDevice* device, const std::string& name, const std::string& value) {
  const auto entries = enumeration_entries(device, name);
  if (std::find(entries.begin(), entries.end(), value) == entries.end()) {
    return refused(name, value, "one of " + joined(entries) + " is expected");
  }
  GErrorSlot error;
  arv_device_set_string_feature_value(device, name.c_str(), value.c_str(), error.out());
  if (error) return error.failure(ErrorCode::invalid_input, "setting " + name + "=" + value);
  return {};
}

Result<void> set_boolean(ArvDevice* device, const std::string& name, const std::string& value) {
  const bool on = value == "true" || value == "1";
  if (!on && value != "false" && value != "0") return refused(name, value, "true or false is expected");
  GErrorSlot error;
  arv_device_set_boolean_feature_value(device, name.c_str(), on ? TRUE : FALSE, error.out());
  if (error) return error.failure(ErrorCode::invalid_input, "setting " + name + "=" + value);
  return {};
}

/// Names of the nodes of one kind below the root. Categories may be nested to any depth.
std::vector<std::string> collect(ArvGc* genicam, Kind wanted) {
  std::vector<std::string> names, open{"Root"};
  std::set<std::string> visited;
  while (!open.empty()) {
    const std::string name = std::move(open.back());
    open.pop_back();
    ArvGcNode* node = arv_gc_get_node(genicam, name.c_str());
    if (node == nullptr || !visited.insert(name).second) continue;
    if (kind_of(node) == wanted) names.push_back(name);
    if (!ARV_IS_GC_CATEGORY(node)) continue;
    const auto members = static_cast<std::ptrdiff_t>(open.size());
    for (const GSList* item = arv_gc_category_get_features(ARV_GC_CATEGORY(node)); item != nullptr; item = item->next) {
      open.emplace_back(static_cast<const char*>(item->data));
    }
    // Visits the first member first.
    std::reverse(open.begin() + members, open.end());
  }
  return names;
}

std::vector<std::string> names_of(ArvDevice* device, Kind wanted) {
  ArvGc* genicam = arv_device_get_genicam(device);
  return genicam != nullptr ? collect(genicam, wanted) : std::vector<std::string>();
}

}  // namespace

bool has_feature(ArvDevice* device, const std::string& name) {
  return kind_of(arv_device_get_feature(device, name.c_str())).has_value() && !feature_fault(device, name) &&
         arv_device_is_feature_available(device, name.c_str(), nullptr) != 0;
}

Result<std::string> get_feature(ArvDevice* device, const std::string& name) {
  TODBENCH_TRY(const auto kind, find(device, name));
  GErrorSlot error;
  std::string text;
  switch (kind) {
    case Kind::integer:
      text = to_text<gint64>(arv_device_get_integer_feature_value(device, name.c_str(), error.out()));
      break;
    case Kind::floating:
      text = to_text(arv_device_get_float_feature_value(device, name.c_str(), error.out()));
      break;
    case Kind::boolean:
      text = arv_device_get_boolean_feature_value(device, name.c_str(), error.out()) != 0 ? "true" : "false";
      break;
    case Kind::enumeration:
    case Kind::text: {
      // If the camera does not answer, Aravis returns uninitialised memory without a terminator.
      const char* value = arv_device_get_string_feature_value(device, name.c_str(), error.out());
      if (!error) text = text_or_empty(value);
      break;
    }
    case Kind::command:
      return fail(ErrorCode::invalid_input, name + " is a command and has no value");
  }
  if (error) return error.failure(ErrorCode::invalid_input, "reading " + name);
  return text;
}

Result<void> set_feature(ArvDevice* device, const std::string& name, const std::string& value) {
  TODBENCH_TRY(const auto kind, find(device, name));
  if (kind != Kind::command && arv_device_get_feature_access_mode(device, name.c_str()) == ARV_GC_ACCESS_MODE_RO) {
    return refused(name, value, "the camera states that it is read-only");
  }
  GErrorSlot error;
  switch (kind) {
    case Kind::integer:
      return set_integer(device, name, value);
    case Kind::floating:
      return set_float(device, name, value);
    case Kind::enumeration:
      return set_enumeration(device, name, value);
    case Kind::boolean:
      return set_boolean(device, name, value);
    case Kind::text:
      arv_device_set_string_feature_value(device, name.c_str(), value.c_str(), error.out());
      break;
    case Kind::command:
      arv_device_execute_command(device, name.c_str(), error.out());
      break;
  }
  if (error) return error.failure(ErrorCode::invalid_input, "setting " + name + "=" + value);
  return {};
}

Result<double> get_number(ArvDevice* device, const std::string& name) {
  TODBENCH_TRY(const auto text, get_feature(device, name));
  const auto number = parsed<double>(text);
  if (!number) return fail(ErrorCode::invalid_input, name + " is not a number but '" + text + "'");
  return *number;
}

std::vector<std::string> enumeration_entries(ArvDevice* device, const std::string& name) {
  ArvGcNode* node = arv_device_get_feature(device, name.c_str());
  if (node == nullptr || !ARV_IS_GC_ENUMERATION(node) || feature_fault(device, name)) return {};
  guint count = 0;
  const GPtr<const char*> names(
      arv_device_dup_available_enumeration_feature_values_as_strings(device, name.c_str(), &count, nullptr));
  if (!names) return {};
  return {names.get(), names.get() + count};
}

std::vector<std::string> command_names(ArvDevice* device) {
  return names_of(device, Kind::command);
}

std::vector<std::string> enumeration_names(ArvDevice* device) {
  return names_of(device, Kind::enumeration);
}

}  // namespace todbench
