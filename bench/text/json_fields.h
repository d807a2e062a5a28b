// SPDX-License-Identifier: GPL-3.0-or-later
// Records in JSON, described once for both directions. A function names keys and members in the order of the object;
// the same function writes the object and reads it.
//
//   void level_fields(JsonFields& json, Level& level) {
//     json.value("size_mrad", level.size);
//     json.value("cluster", level.cluster);
//   }
//   Result<Json> written = json_of(level, level_fields);
//   Result<Level> read = from_json<Level>(*written, level_fields);
#pragma once

#include <concepts>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/text/json_reader.h"

namespace todbench {

/// JSON object that a description writes or reads. A value is a number, whole number, flag, text, interval, or a list,
/// map or optional of values; an empty optional is null. The optional argument `how` is the list of the values that are
/// written as words, or the description of a nested record. Keeps the first mistake. Used for one call of a
/// description.
class JsonFields {
 public:
  /// Describes a key that every record has. Mistakes in reading: missing key, wrong type. Mistake in writing: a number
  /// that is not finite, because it would be read as a missing number. An optional number that is not finite becomes
  /// null.
  template <typename Value, typename... How>
  void value(const std::string& key, Value& value, const How&... how) {
    if (reader_)
      read(reader_->at(key), value, how...);
    else
      put(key, written(path_of(key), value, how...));
  }
  /// Describes a key that older records do not have. If the key is absent or null, the member keeps its value.
  template <typename Value, typename... How>
  void later(const std::string& key, Value& value, const How&... how) {
    if (!reader_)
      put(key, written(path_of(key), value, how...));
    else if (has(key))
      read(reader_->at(key), value, how...);
  }
  /// Describes an optional value whose key is omitted if the value is empty.
  template <typename Value, typename... How>
  void if_any(const std::string& key, std::optional<Value>& value, const How&... how) {
    if (reader_ || value) later(key, value, how...);
  }
  /// Describes a nested object that is omitted if `given` is false, and read if it is present.
  template <typename Record, typename Describe>
  void part_if(bool given, const std::string& key, Record& record, const Describe& describe) {
    if (reader_ || given) later(key, record, describe);
  }
  /// Describes a number that is null if it is not finite; null is read as `otherwise`.
  void number_or(const std::string& key, double& value, double otherwise);
  /// Describes a text that is null if it is empty.
  void text_or_null(const std::string& key, std::string& value);
  /// Describes a member of an optional record whose keys are in this object. The keys are null if the record is empty.
  /// Call begin() for the record first.
  template <typename Record, typename Value, typename... How>
  void member(const std::string& key, std::optional<Record>& record, Value Record::*member, const How&... how) {
    if (record)
      value(key, (*record).*member, how...);
    else if (!reader_)
      put(key, nullptr);
  }
  /// Creates the record if `key` has a value; otherwise empties the record. For reading only.
  template <typename Record>
  void begin(const std::string& key, std::optional<Record>& record) {
    if (reader_) record = has(key) ? std::optional<Record>(std::in_place) : std::nullopt;
  }
  /// Describes a constant text, for example the name of a format. Any other text is a mistake.
  void constant(const std::string& key, std::string_view text);
  /// Describes a value that is written for other programs and not read. A number that is not finite becomes null.
  template <typename Value, typename... How>
  void derived(const std::string& key, Value value, const How&... how) {
    if (reader_) return;
    std::string ignored;
    JsonFields printed(path_, &ignored);
    put(key, printed.written(path_of(key), value, how...));
  }

  /// Returns whether the description reads. The description may then set members that older records do not contain.
  [[nodiscard]] bool reading() const { return reader_ != nullptr; }
  /// Returns whether the key is present and not null. For reading only. A missing key is not a mistake.
  [[nodiscard]] bool has(const std::string& key) const { return !reader_->at_if_there(key).is_null(); }

 private:
  template <typename Record, typename Describe>
  friend Result<Json> json_of(Record record, const Describe& describe);
  template <typename Record, typename Describe>
  friend Json printed_json(Record record, const Describe& describe);
  template <typename Record, typename Describe>
  friend Result<Record> from_json(const Json& json, const Describe& describe);

  explicit JsonFields(const JsonReader* reader) : reader_(reader) {}
  JsonFields(std::string path, std::string* mistake) : path_(std::move(path)), mistake_(mistake) {}

  [[nodiscard]] std::string path_of(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }
  void put(const std::string& key, Json value) { json_[key] = std::move(value); }
  /// Returns the number; notes a mistake if it is not finite.
  [[nodiscard]] Json finite(const std::string& path, double value);

  template <typename Value, typename... How>
  Json written(const std::string& path, Value& value, const How&... how);
  template <typename Value, typename... How>
  static void read(const JsonReader& reader, Value& value, const How&... how);

  const JsonReader* reader_ = nullptr;  // null: writing
  Json json_ = Json::object();
  std::string path_;
  std::string* mistake_ = nullptr;
};

/// Returns the object of a record. Errors: `internal` with the key (a number that is not finite).
template <typename Record, typename Describe>
[[nodiscard]] Result<Json> json_of(Record record, const Describe& describe) {
  std::string mistake;
  JsonFields fields("", &mistake);
  describe(fields, record);
  if (!mistake.empty()) return fail(ErrorCode::internal, mistake);
  return std::move(fields.json_);
}

/// Returns the object of a record that is printed and never read: a number that is not finite is null.
template <typename Record, typename Describe>
[[nodiscard]] Json printed_json(Record record, const Describe& describe) {
  std::string mistake;
  JsonFields fields("", &mistake);
  describe(fields, record);
  return std::move(fields.json_);
}

/// Parses a record. Errors: `invalid_input` with the key (incomplete record, wrong type, unknown word).
template <typename Record, typename Describe>
[[nodiscard]] Result<Record> from_json(const Json& json, const Describe& describe) {
  const JsonReader reader(json);
  JsonFields fields(&reader);
  Record record{};
  describe(fields, record);
  if (const Result<void> complete = reader.finish(); !complete) return tl::unexpected(complete.error());
  return record;
}

/// Writes a record to a file. Errors: the error of the record, with the name of the file at the beginning of its
/// message; `io`.
[[nodiscard]] Result<void> write_json_file(const std::filesystem::path& file, const Result<Json>& record);

namespace json_fields_detail {
template <typename Value>
inline constexpr bool is_optional = false;
template <typename Value>
inline constexpr bool is_optional<std::optional<Value>> = true;
template <typename Value>
inline constexpr bool is_list = false;
template <typename Value>
inline constexpr bool is_list<std::vector<Value>> = true;
template <typename Value>
inline constexpr bool is_map = false;
template <typename Value>
inline constexpr bool is_map<std::map<std::string, Value>> = true;
/// Type that is written to JSON as the result of to_string(): an enumeration, or a class with named values.
template <typename Value>
concept Word = std::is_enum_v<Value> ||(std::is_class_v<Value>&& requires(const Value& value) {
  { to_string(value) } -> std::same_as<std::string_view>;
});
}  // namespace json_fields_detail

template <typename Value, typename... How>
Json JsonFields::written(const std::string& path, Value& value, const How&... how) {
  namespace detail = json_fields_detail;
  if constexpr ((std::invocable<const How&, JsonFields&, Value&> || ...)) {
    JsonFields inner(path, mistake_);
    (how(inner, value), ...);
    return std::move(inner.json_);
  } else if constexpr (std::is_same_v<Value, std::optional<double>>) {
    return json_number(value);
  } else if constexpr (detail::is_optional<Value>) {
    return value ? written(path, *value, how...) : Json(nullptr);
  } else if constexpr (detail::is_list<Value>) {
    Json list = Json::array();
    for (auto& item : value) list.push_back(written(path + "[" + std::to_string(list.size()) + "]", item, how...));
    return list;
  } else if constexpr (detail::is_map<Value>) {
    Json object = Json::object();
    for (auto& [key, item] : value) object[key] = written(path + "." + key, item, how...);
    return object;
  } else if constexpr (detail::Word<Value>) {
    return Json(to_string(value));
  } else if constexpr (std::is_same_v<Value, double>) {
    return finite(path, value);
  } else if constexpr (std::is_same_v<Value, Interval>) {
    return json_interval(value);
  } else {
    return Json(value);
  }
}

template <typename Value, typename... How>
void JsonFields::read(const JsonReader& reader, Value& value, const How&... how) {
  namespace detail = json_fields_detail;
  if constexpr ((std::invocable<const How&, JsonFields&, Value&> || ...)) {
    JsonFields inner(&reader);
    (how(inner, value), ...);
  } else if constexpr (detail::is_optional<Value>) {
    value.reset();
    if (!reader.is_null()) read(reader, value.emplace(), how...);
  } else if constexpr (detail::is_list<Value>) {
    value.clear();
    for (const JsonReader& item : reader.elements()) read(item, value.emplace_back(), how...);
  } else if constexpr (detail::is_map<Value>) {
    value.clear();
    for (const auto& [key, item] : reader.items()) read(item, value[key], how...);
  } else if constexpr (detail::Word<Value>) {
    value = reader.named(how...);
  } else if constexpr (std::is_same_v<Value, double>) {
    value = reader.number();
  } else if constexpr (std::is_same_v<Value, Interval>) {
    value = reader.interval();
  } else if constexpr (std::is_same_v<Value, bool>) {
    value = reader.flag();
  } else if constexpr (std::is_same_v<Value, std::string>) {
    value = reader.text();
  } else if constexpr (std::is_unsigned_v<Value>) {
    value = static_cast<Value>(reader.count());
  } else {
    static_assert(std::is_integral_v<Value>, "a record needs a description");
    value = static_cast<Value>(reader.whole());
  }
}

}  // namespace todbench
