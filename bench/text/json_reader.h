// SPDX-License-Identifier: GPL-3.0-or-later
// Strict JSON reader: a missing key or a wrong type is a mistake, and its message names the key.
#pragma once

#include <cmath>
#include <cstdint>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/text/json.h"

namespace todbench {

/// Reader of one document. Keeps the first mistake; later values are empty. Copies share the mistake. Keeps a reference
/// to the document, which must outlive the reader. One thread at a time.
class JsonReader {
 public:
  explicit JsonReader(const Json& json, std::string path = "")
      : JsonReader(&json, std::move(path), std::make_shared<std::string>()) {}

  /// Returns the value of a key; a missing key is a mistake.
  [[nodiscard]] JsonReader at(const std::string& key) const {
    const std::string path = path_.empty() ? key : path_ + "." + key;
    if (!json_->is_object()) return wrong("an object");
    const auto found = json_->find(key);
    if (found == json_->end()) {
      note("missing key '" + path + "'");
      return {&nothing(), path, mistake_};
    }
    return {&*found, path, mistake_};
  }
  /// Returns the value of a key that older records do not have; null if missing.
  [[nodiscard]] JsonReader at_if_there(const std::string& key) const {
    if (json_->is_object() && !json_->contains(key))
      return {&nothing(), path_.empty() ? key : path_ + "." + key, mistake_};
    return at(key);
  }
  /// Returns the elements of a list.
  [[nodiscard]] std::vector<JsonReader> elements() const {
    std::vector<JsonReader> readers;
    if (!json_->is_array()) (void)wrong("a list");
    if (!json_->is_array()) return readers;
    for (std::size_t i = 0; i < json_->size(); ++i)
      readers.push_back({&(*json_)[i], path_ + "[" + std::to_string(i) + "]", mistake_});
    return readers;
  }
  /// Returns keys and values of an object in their order.
  [[nodiscard]] std::vector<std::pair<std::string, JsonReader>> items() const {
    std::vector<std::pair<std::string, JsonReader>> pairs;
    if (!json_->is_object()) (void)wrong("an object");
    if (!json_->is_object()) return pairs;
    for (const auto& [key, value] : json_->items())
      pairs.emplace_back(key, JsonReader(&value, path_ + "." + key, mistake_));
    return pairs;
  }
  [[nodiscard]] bool is_null() const { return json_->is_null(); }
  /// Return a value of this type; any other type is a mistake.
  [[nodiscard]] double number() const {
    return json_->is_number() ? json_->get<double>() : ((void)wrong("a number"), 0.0);
  }
  [[nodiscard]] std::optional<double> optional_number() const {
    return is_null() ? std::nullopt : std::optional<double>(number());
  }
  [[nodiscard]] std::int64_t whole() const {
    return json_->is_number_integer() ? json_->get<std::int64_t>() : ((void)wrong("a whole number"), 0);
  }
  [[nodiscard]] std::uint64_t count() const {
    return json_->is_number_unsigned() ? json_->get<std::uint64_t>() : ((void)wrong("a whole number of 0 or more"), 0);
  }
  [[nodiscard]] std::string text() const {
    return json_->is_string() ? json_->get<std::string>() : ((void)wrong("a text"), std::string());
  }
  /// Requires this text, for example the name of a format or a unit.
  void expect(std::string_view word) const {
    if (text() != word) (void)wrong("'" + std::string(word) + "'");
  }
  [[nodiscard]] bool flag() const {
    return json_->is_boolean() ? json_->get<bool>() : ((void)wrong("true or false"), false);
  }
  [[nodiscard]] std::vector<double> numbers() const {
    std::vector<double> values;
    for (const JsonReader& element : elements()) values.push_back(element.number());
    return values;
  }
  [[nodiscard]] std::vector<std::string> texts() const {
    std::vector<std::string> values;
    for (const JsonReader& element : elements()) values.push_back(element.text());
    return values;
  }
  /// Returns the element of `values` whose to_string() is the text.
  template <typename Values>
  [[nodiscard]] auto named(const Values& values) const {
    const std::string name = text();
    for (const auto value : values) {
      if (to_string(value) == name) return value;
    }
    (void)wrong("a known word");
    return *std::begin(values);
  }
  /// Returns an interval from a list of two numbers; null is an open limit.
  [[nodiscard]] Interval interval() const {
    const std::vector<JsonReader> sides = elements();
    if (sides.size() == 2) return {sides[0].optional_number(), sides[1].optional_number()};
    note("'" + path_ + "': expected two ends, low and high");
    return {};
  }
  /// Succeeds if there was no mistake.
  [[nodiscard]] Result<void> finish() const {
    if (mistake_->empty()) return {};
    return fail(ErrorCode::invalid_input, *mistake_);
  }

 private:
  JsonReader(const Json* json, std::string path, std::shared_ptr<std::string> mistake)
      : json_(json), path_(std::move(path)), mistake_(std::move(mistake)) {}
  static const Json& nothing() {
    static const Json null;
    return null;
  }
  void note(const std::string& sentence) const {
    if (mistake_->empty()) *mistake_ = sentence;
  }
  [[nodiscard]] JsonReader wrong(const std::string& expected) const {
    note("'" + path_ + "': expected " + expected);
    return {&nothing(), path_, mistake_};
  }

  const Json* json_;
  std::string path_;
  std::shared_ptr<std::string> mistake_;
};

}  // namespace todbench
