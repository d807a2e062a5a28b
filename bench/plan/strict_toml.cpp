// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/strict_toml.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <regex>
#include <set>
#include <utility>

#include "bench/text/text.h"
#include "bench/text/unit_hint.h"

#include <toml++/toml.h>

namespace todbench {

/// Table being read. Tables live as long as their document, so readers may point to them.
struct TomlReader::Table {
  const toml::table* node = nullptr;  ///< null: the file has no such table
  std::string path;
  std::uint32_t line = 1;
  std::set<std::string, std::less<>> asked;

  [[nodiscard]] std::string name_of(std::string_view key) const {
    return "key '" + one_line(key) + "'" + (path.empty() ? "" : " in [" + path + "]");
  }
  [[nodiscard]] std::string path_of(std::string_view key) const {
    return (path.empty() ? "" : path + ".") + std::string(key);
  }
};

/// Shared state of all readers of a file: parsed tree, opened tables and mistakes.
struct TomlReader::Document {
  enum class Kind { present, missing };
  struct Mistake {
    Kind kind;
    std::uint32_t line;
    std::string message;
    ErrorKey key;
  };
  std::string file;
  toml::table root;
  std::vector<Mistake> mistakes;
  std::vector<std::unique_ptr<Table>> tables;

  /// Names the section of a misplaced key; empty unless exactly one section has it.
  [[nodiscard]] std::string section_hint(std::string_view key) const {
    std::set<std::string> sections;
    for (const std::unique_ptr<Table>& table : tables) {
      if (!table->path.empty() && table->asked.contains(key)) sections.insert(table->path);
    }
    return sections.size() == 1 ? ", it is a key of [" + *sections.begin() + "]" : "";
  }
  /// `sentence` includes the key as written in the file.
  [[nodiscard]] Mistake mistake(Kind kind, std::uint32_t line, const std::string& sentence, ErrorKey key) const {
    return {kind, line, file + ":" + std::to_string(line) + ": " + sentence, std::move(key)};
  }
  void wrong(const Table& table, std::string_view key, std::uint32_t line, const std::string& reason) {
    mistakes.push_back(mistake(Kind::present, line, table.name_of(key) + ": " + reason, {table.path_of(key), reason}));
  }
  Table* open(const toml::table* node, const std::string& path, std::uint32_t line) {
    tables.push_back(std::make_unique<Table>());
    tables.back()->node = node;
    tables.back()->path = path;
    tables.back()->line = line;
    return tables.back().get();
  }
  /// Returns the node of a key and marks it as read; a missing key without a fallback is a mistake.
  const toml::node* ask(Table& table, std::string_view key, bool required, const std::string& expected) {
    table.asked.emplace(key);
    const toml::node* node = table.node ? table.node->get(key) : nullptr;
    if (!node && required) {
      mistakes.push_back(mistake(Kind::missing, table.line, "missing " + table.name_of(key) + ", expected " + expected,
                                 {table.path_of(key), "missing, expected " + expected}));
    }
    return node;
  }
};

namespace {

std::string describe_value(const toml::node& node) {
  if (const auto* text = node.as_string()) return "\"" + one_line(text->get()) + "\"";
  if (const auto* real = node.as_floating_point()) {
    if (std::isfinite(real->get())) return number_text(real->get());
    return std::isnan(real->get()) ? "nan" : "inf";
  }
  if (const auto* whole = node.as_integer()) return std::to_string(whole->get());
  if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
  if (node.is_array()) return "a list";
  if (node.is_table()) return "a table";
  return "a date or time";
}

std::string expected_found(const std::string& expected, const toml::node& node) {
  return "expected " + expected + ", found " + describe_value(node);
}

std::uint32_t line_of(const toml::node& node) {
  return std::max<std::uint32_t>(1, node.source().begin.line);
}

std::optional<double> any_number_in(const toml::node& node) {
  return node.is_integer() ? std::optional<double>(static_cast<double>(node.as_integer()->get()))
                           : node.value_exact<double>();
}

std::optional<double> number_in(const toml::node& node, const NumberRange& range) {
  const std::optional<double> value = any_number_in(node);
  return value && range.contains(*value) ? value : std::nullopt;
}

/// Returns "; is the value in mm?" if that would explain the mistake.
std::string hint_for(std::string_view key, const toml::node& node, const NumberRange& range) {
  const std::optional<double> value = any_number_in(node);
  return value ? unit_hint(key, *value, range) : std::string();
}

/// Returns a scalar of a free table as TOML text (strings without quotes); empty for lists, tables and dates.
std::optional<std::string> scalar_text(const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get();
  if (node.is_integer() || node.is_boolean()) return describe_value(node);
  if (node.is_floating_point() && std::isfinite(node.as_floating_point()->get())) return describe_value(node);
  return std::nullopt;
}

/// The line with this number, from 1; empty beyond the end.
std::string_view line_at(std::string_view text, std::size_t number) {
  for (std::size_t i = 1; i < number; ++i) {
    const auto end = text.find('\n');
    if (end == std::string_view::npos) return {};
    text.remove_prefix(end + 1);
  }
  return text.substr(0, text.find_first_of("\r\n"));
}

/// Two frequent mistakes in a line KEY = VALUE: a decimal comma, and a text without quotes. Empty for others.
std::string mistake_hint(std::string_view line) {
  static const std::regex comma(R"(\s*([\w.-]+)\s*=\s*(-?\d+),(\d+)\s*(#.*)?)");
  static const std::regex word(R"(\s*([\w.-]+)\s*=\s*([A-Za-z][^"'#\[\]{}]*?)\s*(#.*)?)");
  constexpr std::size_t longest = 200;
  if (line.size() > longest) return {};
  const std::string whole(line);
  std::smatch found;
  if (std::regex_match(whole, found, comma))
    return "; decimals have a point: " + found[1].str() + " = " + found[2].str() + "." + found[3].str();
  if (std::regex_match(whole, found, word))
    return "; a text has quotes: " + found[1].str() + " = \"" + one_line(found[2].str()) + "\"";
  return {};
}

}  // namespace

Result<TomlReader> TomlReader::parse(std::string_view text, const std::string& file) {
  auto document = std::make_shared<Document>();
  document->file = file;
  // The packaged library reports errors by exceptions; they end here.
  try {
    document->root = toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    const auto line = error.source().begin.line;
    return fail_at(ErrorCode::invalid_input, file + ":" + std::to_string(line),
                   "not valid TOML: " + one_line(error.description()) + mistake_hint(line_at(text, line)));
  }
  Table* root = document->open(&document->root, "", 1);
  return TomlReader(std::move(document), root);
}

std::string TomlReader::text(std::string_view key, const std::optional<std::string>& fallback) {
  const toml::node* node = document_->ask(*table_, key, !fallback, "a text in quotes");
  if (!node) return fallback.value_or("");
  if (const auto* value = node->as_string()) return value->get();
  if (const auto* date = node->as_date())
    return fmt::format("{:04}-{:02}-{:02}", date->get().year, date->get().month, date->get().day);
  document_->wrong(*table_, key, line_of(*node), expected_found("a text in quotes", *node));
  return fallback.value_or("");
}

double TomlReader::number(std::string_view key, const NumberRange& range, std::optional<double> fallback) {
  const toml::node* node = document_->ask(*table_, key, !fallback, range.describe());
  if (!node) return fallback.value_or(0);
  if (const std::optional<double> value = number_in(*node, range)) return *value;
  document_->wrong(*table_, key, line_of(*node), expected_found(range.describe(), *node) + hint_for(key, *node, range));
  return fallback.value_or(0);
}

std::optional<double> TomlReader::optional_number(std::string_view key, const NumberRange& range) {
  if (has(key)) return number(key, range, std::nullopt);
  table_->asked.emplace(key);
  return std::nullopt;
}

std::optional<double> TomlReader::number_or(std::string_view key, const NumberRange& range, std::string_view word,
                                            std::optional<double> fallback) {
  const toml::node* node = document_->ask(*table_, key, false, "");
  if (!node) return fallback;
  if (const auto* value = node->as_string(); value && value->get() == word) return std::nullopt;
  if (const std::optional<double> value = number_in(*node, range)) return value;
  document_->wrong(
      *table_, key, line_of(*node),
      expected_found(range.describe() + " or \"" + std::string(word) + "\"", *node) + hint_for(key, *node, range));
  return fallback;
}

std::int64_t TomlReader::whole(std::string_view key, std::int64_t low, std::int64_t high,
                               std::optional<std::int64_t> fallback) {
  std::string expected = "a whole number from " + std::to_string(low) + " to " + std::to_string(high);
  if (high == std::numeric_limits<std::int64_t>::max())
    expected = "a whole number of " + std::to_string(low) + " or more";
  const toml::node* node = document_->ask(*table_, key, !fallback, expected);
  if (!node) return fallback.value_or(low);
  if (const auto* value = node->as_integer(); value && value->get() >= low && value->get() <= high) return value->get();
  document_->wrong(*table_, key, line_of(*node), expected_found(expected, *node));
  return fallback.value_or(low);
}

std::vector<double> TomlReader::wholes(std::string_view key, std::int64_t low, std::int64_t high,
                                       const std::optional<std::vector<double>>& fallback) {
  const std::string expected = "a whole number from " + std::to_string(low) + " to " + std::to_string(high);
  const toml::node* node = document_->ask(*table_, key, !fallback, expected);
  if (!node) return fallback.value_or(std::vector<double>());
  std::vector<double> values;
  const auto keep = [&](const toml::node& element) {
    const auto* value = element.as_integer();
    if (value && value->get() >= low && value->get() <= high)
      values.push_back(static_cast<double>(value->get()));
    else
      document_->wrong(*table_, key, line_of(element), expected_found(expected, element));
  };
  const auto* list = node->as_array();
  if (!list) keep(*node);
  if (list && list->empty())
    document_->wrong(*table_, key, line_of(*node), expected_found(expected + ", or a list of them", *node));
  if (list) {
    for (const toml::node& element : *list) keep(element);
  }
  return values;
}

bool TomlReader::flag(std::string_view key, std::optional<bool> fallback) {
  const std::string expected = "true or false";
  const toml::node* node = document_->ask(*table_, key, !fallback, expected);
  if (!node) return fallback.value_or(false);
  if (const auto* value = node->as_boolean()) return value->get();
  document_->wrong(*table_, key, line_of(*node), expected_found(expected, *node));
  return fallback.value_or(false);
}

std::string TomlReader::choice(std::string_view key, Words allowed, const std::optional<std::string>& fallback) {
  const toml::node* node = document_->ask(*table_, key, !fallback, one_of(allowed));
  if (!node) return fallback.value_or(allowed.front());
  const auto* value = node->as_string();
  if (value && std::find(allowed.begin(), allowed.end(), value->get()) != allowed.end()) return value->get();
  const std::string suggestion = value ? nearest_name_hint(value->get(), allowed) : "";
  document_->wrong(*table_, key, line_of(*node), expected_found(one_of(allowed), *node) + suggestion);
  return fallback.value_or(allowed.front());
}

std::vector<double> TomlReader::numbers(std::string_view key, const NumberRange& range,
                                        const std::optional<std::vector<double>>& fallback) {
  const std::string expected = "a list, each " + range.describe();
  const toml::node* node = document_->ask(*table_, key, !fallback, expected);
  if (!node) return fallback.value_or(std::vector<double>());
  const auto* list = node->as_array();
  if (!list) {
    document_->wrong(*table_, key, line_of(*node), expected_found(expected, *node));
    return {};
  }
  std::vector<double> values;
  for (const toml::node& element : *list) {
    const std::optional<double> value = number_in(element, range);
    if (!value)
      document_->wrong(*table_, key, line_of(element),
                       expected_found(range.describe(), element) + hint_for(key, element, range));
    values.push_back(value.value_or(0));
  }
  return values;
}

std::vector<std::string> TomlReader::texts(std::string_view key,
                                           const std::optional<std::vector<std::string>>& fallback) {
  const std::string expected = "a list of texts in quotes";
  const toml::node* node = document_->ask(*table_, key, !fallback, expected);
  if (!node) return fallback.value_or(std::vector<std::string>());
  const auto* list = node->as_array();
  if (!list) {
    document_->wrong(*table_, key, line_of(*node), expected_found(expected, *node));
    return {};
  }
  std::vector<std::string> values;
  for (const toml::node& element : *list) {
    const auto* value = element.as_string();
    if (!value) document_->wrong(*table_, key, line_of(element), expected_found("a text in quotes", element));
    values.push_back(value ? value->get() : std::string());
  }
  return values;
}

std::vector<std::string> TomlReader::choices(std::string_view key, Words allowed,
                                             const std::optional<std::vector<std::string>>& fallback) {
  std::vector<std::string> values = texts(key, fallback);
  const auto* list = table_->node && has(key) ? table_->node->get(key)->as_array() : nullptr;
  for (std::size_t i = 0; list && i < values.size(); ++i) {
    const toml::node& element = *list->get(i);
    if (!element.is_string() || std::find(allowed.begin(), allowed.end(), values[i]) != allowed.end()) continue;
    document_->wrong(*table_, key, line_of(element),
                     expected_found(one_of(allowed), element) + nearest_name_hint(values[i], allowed));
  }
  return values;
}

std::map<std::string, std::string> TomlReader::free_table(std::string_view key) {
  std::map<std::string, std::string> values;
  const toml::node* node = document_->ask(*table_, key, false, "");
  if (!node) return values;
  const auto* table = node->as_table();
  if (!table) {
    document_->wrong(*table_, key, line_of(*node), expected_found("a table of names and values", *node));
    return values;
  }
  for (const auto& [name, value] : *table) {
    const std::optional<std::string> text = scalar_text(value);
    if (!text)
      document_->wrong(*table_, name.str(), line_of(value), expected_found("a text, a number, true or false", value));
    values.emplace(name.str(), text.value_or(""));
  }
  return values;
}

TomlReader TomlReader::section(std::string_view key) {
  const toml::node* node = document_->ask(*table_, key, false, "");
  const toml::table* table = node ? node->as_table() : nullptr;
  if (node && !table)
    document_->wrong(*table_, key, line_of(*node), expected_found("a table [" + std::string(key) + "]", *node));
  const std::string path = table_->path_of(key);
  return {document_, document_->open(table, path, node ? line_of(*node) : table_->line)};
}

std::vector<TomlReader> TomlReader::sections(std::string_view key) {
  std::vector<TomlReader> readers;
  const toml::node* node = document_->ask(*table_, key, false, "");
  if (!node) return readers;
  const std::string path = table_->path_of(key);
  const auto* list = node->as_array();
  if (!list) {
    document_->wrong(*table_, key, line_of(*node), expected_found("tables [[" + path + "]]", *node));
    return readers;
  }
  for (const toml::node& element : *list) {
    const auto* table = element.as_table();
    if (!table) document_->wrong(*table_, key, line_of(element), expected_found("tables [[" + path + "]]", element));
    if (table) readers.push_back({document_, document_->open(table, path, line_of(element))});
  }
  return readers;
}

bool TomlReader::has(std::string_view key) const {
  return table_->node && table_->node->contains(key);
}

bool TomlReader::present() const {
  return table_->node != nullptr;
}

void TomlReader::reject(std::string_view key, const std::string& sentence) {
  const toml::node* node = table_->node ? table_->node->get(key) : nullptr;
  document_->wrong(*table_, key, node ? line_of(*node) : table_->line, sentence);
}

void TomlReader::reject(std::string_view key, std::size_t index, const std::string& sentence) {
  const toml::node* node = table_->node ? table_->node->get(key) : nullptr;
  const auto* list = node ? node->as_array() : nullptr;
  if (list && index < list->size()) {
    document_->wrong(*table_, key, line_of(*list->get(index)), sentence);
  } else {
    reject(key, sentence);
  }
}

Result<void> TomlReader::finish() const {
  std::vector<Document::Mistake> mistakes = document_->mistakes;
  for (const std::unique_ptr<Table>& table : document_->tables) {
    if (!table->node) continue;
    const std::vector<std::string> known(table->asked.begin(), table->asked.end());
    for (const auto& [key, value] : *table->node) {
      if (table->asked.contains(key.str())) continue;
      const std::uint32_t line = std::max<std::uint32_t>(1, key.source().begin.line);
      std::string hint = nearest_name_hint(key.str(), known);
      if (hint.empty()) hint = document_->section_hint(key.str());
      mistakes.push_back(document_->mistake(Document::Kind::present, line,
                                            "unknown " + table->name_of(key.str()) + hint,
                                            {table->path_of(key.str()), "unknown" + hint}));
    }
  }
  if (mistakes.empty()) return {};
  const auto first = std::min_element(mistakes.begin(), mistakes.end(), [](const auto& a, const auto& b) {
    return std::pair(a.kind, a.line) < std::pair(b.kind, b.line);
  });
  return tl::unexpected(Error{ErrorCode::invalid_input, first->message, first->key});
}

}  // namespace todbench
