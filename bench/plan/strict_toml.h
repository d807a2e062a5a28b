// SPDX-License-Identifier: GPL-3.0-or-later
// Strict TOML reader: unknown keys are mistakes, every value has a type and a range, and messages state file and line.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/number_range.h"
#include "acquisition/base/result.h"

namespace todbench {

/// Table of a TOML document during reading. Mistakes are collected, so reading code is a plain list of assignments.
/// After a mistake a reader returns the fallback (or an empty value), and finish() fails; the values must then not be
/// used. Without a fallback the key is required. Copies share the document. One thread at a time.
class TomlReader {
 public:
  using Words = std::span<const std::string>;

  /// Parses `text`; `file` is its name in messages. Errors: `invalid_input` "FILE:LINE: ..." (invalid TOML).
  [[nodiscard]] static Result<TomlReader> parse(std::string_view text, const std::string& file);

  /// Reads a text.
  [[nodiscard]] std::string text(std::string_view key, const std::optional<std::string>& fallback);
  /// Reads a number in `range`.
  [[nodiscard]] double number(std::string_view key, const NumberRange& range, std::optional<double> fallback);
  /// Reads a whole number from `low` to `high`.
  [[nodiscard]] std::int64_t whole(std::string_view key, std::int64_t low, std::int64_t high,
                                   std::optional<std::int64_t> fallback);
  /// Reads a whole number, or a list of at least one.
  [[nodiscard]] std::vector<double> wholes(std::string_view key, std::int64_t low, std::int64_t high,
                                           const std::optional<std::vector<double>>& fallback);
  /// Reads true or false.
  [[nodiscard]] bool flag(std::string_view key, std::optional<bool> fallback);
  /// Reads one of the words in `allowed`.
  [[nodiscard]] std::string choice(std::string_view key, Words allowed, const std::optional<std::string>& fallback);
  /// Read lists. An empty list is a value, not a missing key.
  [[nodiscard]] std::vector<double> numbers(std::string_view key, const NumberRange& range,
                                            const std::optional<std::vector<double>>& fallback);
  [[nodiscard]] std::vector<std::string> texts(std::string_view key,
                                               const std::optional<std::vector<std::string>>& fallback);
  [[nodiscard]] std::vector<std::string> choices(std::string_view key, Words allowed,
                                                 const std::optional<std::vector<std::string>>& fallback);
  /// Reads a number in `range`; empty for the word `word`; `fallback` if the key is missing.
  [[nodiscard]] std::optional<double> number_or(std::string_view key, const NumberRange& range, std::string_view word,
                                                std::optional<double> fallback);
  /// Reads a number in `range`; empty if the key is missing.
  [[nodiscard]] std::optional<double> optional_number(std::string_view key, const NumberRange& range);
  /// Reads a table with free keys and values as text, for example camera settings. Numbers and booleans become their
  /// TOML text.
  [[nodiscard]] std::map<std::string, std::string> free_table(std::string_view key);

  /// Returns a sub-table; if absent, an empty one in which all keys are missing.
  [[nodiscard]] TomlReader section(std::string_view key);
  /// Returns an array of tables ([[key]]); empty if absent.
  [[nodiscard]] std::vector<TomlReader> sections(std::string_view key);

  /// Returns whether the table contains the key.
  [[nodiscard]] bool has(std::string_view key) const;
  /// Returns whether the file contains this table.
  [[nodiscard]] bool present() const;

  /// Records a mistake at a key of this table, or at element `index` of its list: "FILE:LINE: key 'KEY' in [SECTION]:
  /// SENTENCE".
  void reject(std::string_view key, const std::string& sentence);
  void reject(std::string_view key, std::size_t index, const std::string& sentence);

  /// Succeeds if there was no mistake and every key of the document was read. Otherwise returns the first mistake by
  /// line, unknown keys before missing keys (a misspelt key is usually both), as `invalid_input` with its key. Covers
  /// the whole document, regardless of the reader on which it is called.
  [[nodiscard]] Result<void> finish() const;

 private:
  struct Document;
  struct Table;
  TomlReader(std::shared_ptr<Document> document, Table* table) : document_(std::move(document)), table_(table) {}
  std::shared_ptr<Document> document_;
  Table* table_;  ///< owned by the document
};

}  // namespace todbench
