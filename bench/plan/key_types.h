// What a key of a description may hold: as TOML, as text of a form or a command line, and whether it is in range.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "acquisition/core/result.h"
#include "bench/plan/resources.h"
#include "bench/plan/strict_toml.h"

namespace todbench {

/// The value of any key; std::monostate: there is none.
using KeyValue = std::variant<std::monostate, bool, std::int64_t, double, std::string, std::vector<double>,
                              std::vector<std::string>, std::map<std::string, std::string>>;

struct TextKey {};
struct FlagKey {};
struct NumberKey {
  NumberRange range;
};
/// A number, or nothing: then the file has no such key.
struct OptionalNumberKey {
  NumberRange range;
};
/// A number, or nothing, for which a word stands.
struct NumberOrWordKey {
  NumberRange range;
  std::string_view word;
};
struct WholeKey {
  std::int64_t low = 0;
  std::int64_t high = 0;
};
/// One, or a list of one or more.
struct WholesKey {
  WholeKey each{};
};
struct ChoiceKey {
  std::vector<std::string> words;
};
/// Lists. `noun` is what one of them is called.
struct NumbersKey {
  NumberRange range;
  std::string_view noun;
  std::optional<std::size_t> count{};  ///< nothing: one or more
};
enum class MayBeEmpty { no, yes };
/// Each word at most once.
struct ChoicesKey {
  std::vector<std::string> words;
  std::string_view noun;
  MayBeEmpty may_be_empty = MayBeEmpty::no;
};
/// Name or file of a description.
/// What a plate that is named alone is for.
enum class PlateUse { mtf, ctf };
struct ResourceKey {
  ResourceKind kind;
  PlateUse use = PlateUse::mtf;  ///< of a plate
};
struct ResourcesKey {
  ResourceKind kind;
};
/// A table of names that are free, values as text.
struct FreeTableKey {};

using KeyType = std::variant<TextKey, FlagKey, NumberKey, OptionalNumberKey, NumberOrWordKey, WholeKey, WholesKey,
                             ChoiceKey, NumbersKey, ChoicesKey, ResourceKey, ResourcesKey, FreeTableKey>;

/// "a number above 0", "one of 'a', 'b'": what a key takes, for messages, tooltips and documents.
[[nodiscard]] std::string expected_of(const KeyType& type);

/// Something wrong with a value.
struct ValueMistake {
  std::optional<std::size_t> element;  ///< of a list
  std::string sentence;                ///< "expected a number above 0, found -1"
};
/// What the type alone says against a value of its kind. What a resource names is not looked at.
[[nodiscard]] std::vector<ValueMistake> mistakes_of(const KeyType& type, const KeyValue& value);

/// Reads a key. A wrong value is recorded in the reader and the fallback returned; without a fallback the key has to be
/// there.
[[nodiscard]] KeyValue read_value(const KeyType& type, TomlReader& reader, std::string_view key,
                                  const std::optional<KeyValue>& fallback);
/// The right side of "key = value"; nothing where TOML says it by leaving the key out. Free tables have no such side.
[[nodiscard]] std::optional<std::string> toml_value(const KeyType& type, const KeyValue& value);
/// A basic string of TOML, in quotes.
[[nodiscard]] std::string toml_string(std::string_view text);

/// As a person reads and writes it in one line: numbers plainly, lists with commas, yes and no, nothing as an empty
/// text or the word that stands for it.
[[nodiscard]] std::string plain_text(const KeyType& type, const KeyValue& value);
/// The other way round. `invalid_input` says in a sentence what is wrong, range included, without the key's name.
[[nodiscard]] Result<KeyValue> value_from_text(const KeyType& type, std::string_view text);

}  // namespace todbench
