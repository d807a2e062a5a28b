// SPDX-License-Identifier: GPL-3.0-or-later
// Types of the keys of a description: TOML, text of a form or command line, and range.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/plan/resources.h"
#include "bench/plan/strict_toml.h"

namespace todbench {

/// Value of any key; std::monostate: absent.
using KeyValue = std::variant<std::monostate, bool, std::int64_t, double, std::string, std::vector<double>,
                              std::vector<std::string>, std::map<std::string, std::string>>;

/// Text.
struct TextKey {};
/// True or false.
struct FlagKey {};
/// Number in a range.
struct NumberKey {
  NumberRange range;
};
/// Optional number; empty if the file does not contain the key.
struct OptionalNumberKey {
  NumberRange range;
};
/// Optional number. The file contains `word` for an empty value.
struct NumberOrWordKey {
  NumberRange range;
  std::string_view word;
};
/// Whole number from `low` to `high`.
struct WholeKey {
  std::int64_t low = 0;
  std::int64_t high = 0;
};
/// One whole number, or a list of at least one.
struct WholesKey {
  WholeKey each{};
};
/// One of `words`.
struct ChoiceKey {
  std::vector<std::string> words;
};
/// Whether an empty list is accepted.
enum class MayBeEmpty { no, yes };
/// List of numbers. `noun` is the name of an element in messages.
struct NumbersKey {
  NumberRange range;
  std::string_view noun;
  std::optional<std::size_t> count{};  ///< empty: at least one
  MayBeEmpty may_be_empty = MayBeEmpty::no;
};
/// List of words, each at most once.
struct ChoicesKey {
  std::vector<std::string> words;
  std::string_view noun;
  MayBeEmpty may_be_empty = MayBeEmpty::no;
};
/// Use of a plate that a single key names; indexes measure_plates (loaded_plan.h).
enum class PlateUse { mtf, ctf, source_size, absolute, mrtd };
/// Name or file of a description.
struct ResourceKey {
  ResourceKind kind;
  PlateUse use = PlateUse::mtf;  ///< use of the plate, for kind plate
};
/// List of names or files of descriptions.
struct ResourcesKey {
  ResourceKind kind;
};
/// Table with free names; values as text.
struct FreeTableKey {};

using KeyType = std::variant<TextKey, FlagKey, NumberKey, OptionalNumberKey, NumberOrWordKey, WholeKey, WholesKey,
                             ChoiceKey, NumbersKey, ChoicesKey, ResourceKey, ResourcesKey, FreeTableKey>;

/// Returns the accepted values for messages, tooltips and documents: "a number above 0", "one of 'a', 'b'".
[[nodiscard]] std::string expected_of(const KeyType& type);

/// Mistake in a value.
struct ValueMistake {
  std::optional<std::size_t> element;  ///< index, if the value is a list
  std::string sentence;                ///< "expected a number above 0, found -1"
};
using ValueMistakes = std::vector<ValueMistake>;

/// Returns the mistakes that follow from the type alone. Resources are not looked up.
[[nodiscard]] std::vector<ValueMistake> mistakes_of(const KeyType& type, const KeyValue& value);

/// Reads a key. A wrong value is recorded in the reader, and the fallback is returned. Without a fallback the key is
/// required.
[[nodiscard]] KeyValue read_value(const KeyType& type, TomlReader& reader, std::string_view key,
                                  const std::optional<KeyValue>& fallback);
/// Returns the right side of "key = value"; empty if the value is expressed by leaving the key out, and for free
/// tables.
[[nodiscard]] std::optional<std::string> toml_value(const KeyType& type, const KeyValue& value);
/// Returns `text` as a quoted basic string of TOML.
[[nodiscard]] std::string toml_string(std::string_view text);

/// Returns the value as one line of text for people: plain numbers, lists with commas, yes and no; an absent value as
/// empty text or as its word.
[[nodiscard]] std::string plain_text(const KeyType& type, const KeyValue& value);
/// Converts the text of plain_text() back to the value. Errors: `invalid_input`, a sentence with the accepted range but
/// without the name of the key.
[[nodiscard]] Result<KeyValue> value_from_text(const KeyType& type, std::string_view text);

}  // namespace todbench
