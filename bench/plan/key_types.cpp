// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/key_types.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "bench/text/text.h"

namespace todbench {
namespace {

template <typename... Handlers>
struct Overloaded : Handlers... {
  using Handlers::operator()...;
};
template <typename... Handlers>
Overloaded(Handlers...) -> Overloaded<Handlers...>;

std::string found(const std::string& expected, const std::string& what) {
  return "expected " + expected + ", found " + what;
}

std::string number_found(double value) {
  return std::isfinite(value) ? number_text(value) : std::isnan(value) ? "nan" : "inf";
}

std::vector<ValueMistake> number_mistakes(const NumberRange& range, double value, const std::string& expected) {
  if (range.contains(value)) return {};
  return {{std::nullopt, found(expected, number_found(value))}};
}

bool is_among(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

std::string word_found(const std::vector<std::string>& words, const std::string& word) {
  return found(one_of(words), "\"" + one_line(word) + "\"") + nearest_name_hint(word, words);
}

/// Mistakes: an empty list where one is required, or a duplicate.
std::vector<ValueMistake> list_mistakes(const std::vector<std::string>& list, std::string_view noun,
                                        MayBeEmpty may_be_empty) {
  std::vector<ValueMistake> mistakes;
  if (list.empty() && may_be_empty == MayBeEmpty::no)
    mistakes.push_back({std::nullopt, "expected at least one " + std::string(noun)});
  std::set<std::string> seen;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (!seen.insert(list[i]).second) mistakes.push_back({i, "'" + one_line(list[i]) + "' is listed twice"});
  }
  return mistakes;
}

std::vector<ValueMistake> numbers_mistakes(const NumbersKey& type, const std::vector<double>& list) {
  std::vector<ValueMistake> mistakes;
  if (list.empty() && type.may_be_empty == MayBeEmpty::yes) return {};
  if (type.count && list.size() != *type.count) return {{std::nullopt, "expected " + std::string(type.noun)}};
  if (!type.count && list.empty()) return {{std::nullopt, "expected at least one " + std::string(type.noun)}};
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (!type.range.contains(list[i])) mistakes.push_back({i, found(type.range.describe(), number_found(list[i]))});
  }
  return mistakes;
}

std::vector<ValueMistake> choices_mistakes(const ChoicesKey& type, const std::vector<std::string>& list) {
  std::vector<ValueMistake> mistakes = list_mistakes(list, type.noun, type.may_be_empty);
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (!is_among(type.words, list[i])) mistakes.push_back({i, word_found(type.words, list[i])});
  }
  return mistakes;
}

std::string whole_expected(const WholeKey& type) {
  if (type.high == std::numeric_limits<std::int64_t>::max())
    return "a whole number of " + std::to_string(type.low) + " or more";
  return "a whole number from " + std::to_string(type.low) + " to " + std::to_string(type.high);
}

std::string wholes_expected(const WholesKey& type) {
  return whole_expected(type.each) + ", or a list of them";
}

/// Lists keep whole numbers as doubles.
bool is_whole(const WholeKey& type, double value) {
  return value == std::floor(value) && value >= static_cast<double>(type.low) &&
         value <= static_cast<double>(type.high);
}

std::string number_or_word_expected(const NumberOrWordKey& type) {
  return type.range.describe() + " or \"" + std::string(type.word) + "\"";
}

template <typename T, typename Write>
std::string joined(const std::vector<T>& list, const Write& write) {
  std::string text;
  for (const T& element : list) text += (text.empty() ? "" : ", ") + write(element);
  return text;
}

/// Returns the parts between commas, trimmed; empty for an empty text.
std::vector<std::string> parts_of(std::string_view text) {
  std::vector<std::string> parts;
  while (!text.empty()) {
    const std::size_t comma = std::min(text.find(','), text.size());
    std::string_view part = text.substr(0, comma);
    text.remove_prefix(std::min(comma + 1, text.size()));
    while (part.starts_with(' ')) part.remove_prefix(1);
    while (part.ends_with(' ')) part.remove_suffix(1);
    if (!part.empty()) parts.emplace_back(part);
  }
  return parts;
}

tl::unexpected<Error> refused(const std::string& expected, std::string_view text) {
  return fail(ErrorCode::invalid_input, found(expected, "'" + one_line(text) + "'"));
}

Result<KeyValue> number_from(const NumberRange& range, const std::string& expected, std::string_view text) {
  const std::optional<double> value = parse_number(text);
  if (!value || !range.contains(*value)) return refused(expected, text);
  return KeyValue(*value);
}

Result<KeyValue> whole_from(const WholeKey& type, std::string_view text) {
  const std::optional<double> value = parse_number(text);
  // A double holds whole numbers exactly up to 2^53; larger ones need a file.
  if (!value || *value != std::floor(*value) || std::abs(*value) > 0x1p53) return refused(whole_expected(type), text);
  const auto whole = static_cast<std::int64_t>(*value);
  if (whole < type.low || whole > type.high) return refused(whole_expected(type), text);
  return KeyValue(whole);
}

Result<KeyValue> wholes_from(const WholesKey& type, std::string_view text) {
  std::vector<double> numbers;
  for (const std::string& part : parts_of(text)) {
    const std::optional<double> value = parse_number(part);
    if (!value || !is_whole(type.each, *value)) return refused(whole_expected(type.each), part);
    numbers.push_back(*value);
  }
  if (numbers.empty()) return refused(wholes_expected(type), text);
  return KeyValue(std::move(numbers));
}

Result<KeyValue> numbers_from(const NumbersKey& type, std::string_view text) {
  std::vector<double> numbers;
  for (const std::string& part : parts_of(text)) {
    const std::optional<double> value = parse_number(part);
    if (!value || !type.range.contains(*value)) return refused(type.range.describe(), part);
    numbers.push_back(*value);
  }
  return KeyValue(std::move(numbers));
}

Result<KeyValue> choices_from(const ChoicesKey& type, std::string_view text) {
  std::vector<std::string> words = parts_of(text);
  for (const std::string& word : words) {
    if (is_among(type.words, word)) continue;
    return fail(ErrorCode::invalid_input, "unknown " + std::string(type.noun) + " '" + one_line(word) + "'" +
                                              nearest_name_hint(word, type.words) +
                                              " (known: " + quoted_list(type.words) + ")");
  }
  return KeyValue(std::move(words));
}

std::optional<std::vector<std::string>> texts_of(const std::optional<KeyValue>& fallback) {
  if (!fallback) return std::nullopt;
  return std::get<std::vector<std::string>>(*fallback);
}

template <typename T>
std::optional<T> alternative(const std::optional<KeyValue>& value) {
  if (!value || std::holds_alternative<std::monostate>(*value)) return std::nullopt;
  return std::get<T>(*value);
}

KeyValue or_nothing(const std::optional<double>& value) {
  return value ? KeyValue(*value) : KeyValue();
}

}  // namespace

std::string expected_of(const KeyType& type) {
  return std::visit(Overloaded{[](const TextKey&) -> std::string { return "a text"; },
                               [](const FlagKey&) -> std::string { return "true or false"; },
                               [](const NumberKey& t) { return t.range.describe(); },
                               [](const OptionalNumberKey& t) { return t.range.describe(); },
                               [](const NumberOrWordKey& t) { return number_or_word_expected(t); },
                               [](const WholeKey& t) { return whole_expected(t); },
                               [](const WholesKey& t) { return wholes_expected(t); },
                               [](const ChoiceKey& t) { return one_of(t.words); },
                               [](const NumbersKey& t) {
                                 return (t.count ? std::string(t.noun) : "a list") + ", each " + t.range.describe();
                               },
                               [](const ChoicesKey& t) { return "a list, each " + one_of(t.words); },
                               [](const ResourceKey& t) {
                                 return std::string(resource_names(t.kind).empty() ? "a file" : "a name or a file");
                               },
                               [](const ResourcesKey&) -> std::string { return "a list, each a name or a file"; },
                               [](const FreeTableKey&) -> std::string { return "a table of names and values"; }},
                    type);
}

std::vector<ValueMistake> mistakes_of(const KeyType& type, const KeyValue& value) {
  using Mistakes = std::vector<ValueMistake>;
  const bool nothing = std::holds_alternative<std::monostate>(value);
  return std::visit(
      Overloaded{
          [](const TextKey&) { return Mistakes(); }, [](const FlagKey&) { return Mistakes(); },
          [&](const NumberKey& t) { return number_mistakes(t.range, std::get<double>(value), t.range.describe()); },
          [&](const OptionalNumberKey& t) {
            return nothing ? Mistakes() : number_mistakes(t.range, std::get<double>(value), t.range.describe());
          },
          [&](const NumberOrWordKey& t) {
            return nothing ? Mistakes() : number_mistakes(t.range, std::get<double>(value), number_or_word_expected(t));
          },
          [&](const WholeKey& t) {
            const auto whole = std::get<std::int64_t>(value);
            if (whole >= t.low && whole <= t.high) return Mistakes();
            return Mistakes{{std::nullopt, found(whole_expected(t), std::to_string(whole))}};
          },
          [&](const WholesKey& t) {
            const auto& list = std::get<std::vector<double>>(value);
            Mistakes mistakes;
            if (list.empty()) mistakes.push_back({std::nullopt, "expected " + wholes_expected(t)});
            for (std::size_t i = 0; i < list.size(); ++i) {
              if (!is_whole(t.each, list[i]))
                mistakes.push_back({i, found(whole_expected(t.each), number_found(list[i]))});
            }
            return mistakes;
          },
          [&](const ChoiceKey& t) {
            const auto& word = std::get<std::string>(value);
            if (is_among(t.words, word)) return Mistakes();
            return Mistakes{{std::nullopt, word_found(t.words, word)}};
          },
          [&](const NumbersKey& t) { return numbers_mistakes(t, std::get<std::vector<double>>(value)); },
          [&](const ChoicesKey& t) { return choices_mistakes(t, std::get<std::vector<std::string>>(value)); },
          [](const ResourceKey&) { return Mistakes(); },
          [&](const ResourcesKey& t) {
            return list_mistakes(std::get<std::vector<std::string>>(value), to_string(t.kind), MayBeEmpty::no);
          },
          [](const FreeTableKey&) { return Mistakes(); }},
      type);
}

KeyValue read_value(const KeyType& type, TomlReader& reader, std::string_view key,
                    const std::optional<KeyValue>& fallback) {
  const auto text = [&] { return KeyValue(reader.text(key, alternative<std::string>(fallback))); };
  return std::visit(
      Overloaded{
          [&](const TextKey&) { return text(); },
          [&](const FlagKey&) { return KeyValue(reader.flag(key, alternative<bool>(fallback))); },
          [&](const NumberKey& t) { return KeyValue(reader.number(key, t.range, alternative<double>(fallback))); },
          [&](const OptionalNumberKey& t) { return or_nothing(reader.optional_number(key, t.range)); },
          [&](const NumberOrWordKey& t) {
            return or_nothing(reader.number_or(key, t.range, t.word, alternative<double>(fallback)));
          },
          [&](const WholeKey& t) {
            return KeyValue(reader.whole(key, t.low, t.high, alternative<std::int64_t>(fallback)));
          },
          [&](const WholesKey& t) {
            return KeyValue(reader.wholes(key, t.each.low, t.each.high, alternative<std::vector<double>>(fallback)));
          },
          [&](const ChoiceKey& t) { return KeyValue(reader.choice(key, t.words, alternative<std::string>(fallback))); },
          [&](const NumbersKey& t) {
            return KeyValue(reader.numbers(key, t.range, alternative<std::vector<double>>(fallback)));
          },
          [&](const ChoicesKey& t) { return KeyValue(reader.choices(key, t.words, texts_of(fallback))); },
          [&](const ResourceKey&) { return text(); },
          [&](const ResourcesKey&) { return KeyValue(reader.texts(key, texts_of(fallback))); },
          [&](const FreeTableKey&) { return KeyValue(reader.free_table(key)); }},
      type);
}

std::string toml_string(std::string_view text) {
  static constexpr char hex[] = "0123456789ABCDEF";
  std::string result = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (byte < 0x20 || byte == 0x7f) {
      result += "\\u00";
      result += hex[byte / 16];
      result += hex[byte % 16];
    } else {
      result += c;
    }
  }
  return result + "\"";
}

std::optional<std::string> toml_value(const KeyType& type, const KeyValue& value) {
  using Text = std::optional<std::string>;
  return std::visit(
      Overloaded{[&](std::monostate) {
                   const auto* worded = std::get_if<NumberOrWordKey>(&type);
                   return worded != nullptr ? Text(toml_string(worded->word)) : Text();
                 },
                 [](bool flag) { return Text(flag ? "true" : "false"); },
                 [](std::int64_t whole) { return Text(std::to_string(whole)); },
                 [](double number) { return Text(number_text(number)); },
                 [](const std::string& text) { return Text(toml_string(text)); },
                 [&](const std::vector<double>& list) {
                   const bool one = list.size() == 1 && std::holds_alternative<WholesKey>(type);
                   return Text(one ? number_text(list[0]) : "[" + joined(list, number_text) + "]");
                 },
                 [](const std::vector<std::string>& list) { return Text("[" + joined(list, toml_string) + "]"); },
                 [](const std::map<std::string, std::string>&) { return Text(); }},
      value);
}

std::string plain_text(const KeyType& type, const KeyValue& value) {
  return std::visit(
      Overloaded{[&](std::monostate) {
                   const auto* worded = std::get_if<NumberOrWordKey>(&type);
                   return worded != nullptr ? std::string(worded->word) : std::string();
                 },
                 [](bool flag) { return std::string(flag ? "yes" : "no"); },
                 [](std::int64_t whole) { return std::to_string(whole); },
                 [](double number) { return number_text(number); }, [](const std::string& text) { return text; },
                 [](const std::vector<double>& list) { return joined(list, number_text); },
                 [](const std::vector<std::string>& list) {
                   return joined(list, [](const std::string& text) { return text; });
                 },
                 [](const std::map<std::string, std::string>& table) {
                   std::string text;
                   for (const auto& [name, setting] : table) text += (text.empty() ? "" : ", ") + name + ": " + setting;
                   return text;
                 }},
      value);
}

Result<KeyValue> value_from_text(const KeyType& type, std::string_view text) {
  using Value = Result<KeyValue>;
  return std::visit(
      Overloaded{[&](const TextKey&) { return Value(std::string(text)); },
                 [&](const FlagKey&) {
                   return text == "yes" || text == "no" ? Value(text == "yes") : Value(refused("yes or no", text));
                 },
                 [&](const NumberKey& t) { return number_from(t.range, t.range.describe(), text); },
                 [&](const OptionalNumberKey& t) {
                   return text.empty() ? Value(KeyValue()) : number_from(t.range, t.range.describe(), text);
                 },
                 [&](const NumberOrWordKey& t) {
                   return text == t.word ? Value(KeyValue()) : number_from(t.range, number_or_word_expected(t), text);
                 },
                 [&](const WholeKey& t) { return whole_from(t, text); },
                 [&](const WholesKey& t) { return wholes_from(t, text); },
                 [&](const ChoiceKey& t) {
                   return is_among(t.words, std::string(text))
                              ? Value(std::string(text))
                              : Value(fail(ErrorCode::invalid_input, word_found(t.words, std::string(text))));
                 },
                 [&](const NumbersKey& t) { return numbers_from(t, text); },
                 [&](const ChoicesKey& t) { return choices_from(t, text); },
                 [&](const ResourceKey&) { return Value(std::string(text)); },
                 [&](const ResourcesKey&) { return Value(parts_of(text)); },
                 [&](const FreeTableKey&) { return Value(refused("a table in a plan file", text)); }},
      type);
}

}  // namespace todbench
