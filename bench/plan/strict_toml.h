// TOML read strictly: every key has to be asked for, every value has its type and range, and what is wrong is said with
// file and line.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/number_range.h"
#include "acquisition/core/result.h"

namespace todbench {

/// A table of a TOML document while it is read. Mistakes are collected, so that reading code is a plain list of
/// assignments: after a mistake a reader hands out the fallback (or an empty value), and finish() says that nothing
/// read is to be used. Copies share the document. A fallback of nothing means that the key has to be there. One thread
/// at a time.
class TomlReader {
 public:
  using Words = std::span<const std::string>;

  /// Parses `text`; `file` is what messages call it. `invalid_input` "FILE:LINE: ..." where it is not TOML.
  [[nodiscard]] static Result<TomlReader> parse(std::string_view text, const std::string& file);

  [[nodiscard]] std::string text(std::string_view key, const std::optional<std::string>& fallback);
  [[nodiscard]] double number(std::string_view key, const NumberRange& range, std::optional<double> fallback);
  [[nodiscard]] std::int64_t whole(std::string_view key, std::int64_t low, std::int64_t high,
                                   std::optional<std::int64_t> fallback);
  /// A whole number, or a list of one or more.
  [[nodiscard]] std::vector<double> wholes(std::string_view key, std::int64_t low, std::int64_t high,
                                           const std::optional<std::vector<double>>& fallback);
  /// true or false.
  [[nodiscard]] bool flag(std::string_view key, std::optional<bool> fallback);
  /// One of the words in `allowed`.
  [[nodiscard]] std::string choice(std::string_view key, Words allowed, const std::optional<std::string>& fallback);
  /// Lists. An empty list is a value, not a missing key.
  [[nodiscard]] std::vector<double> numbers(std::string_view key, const NumberRange& range,
                                            const std::optional<std::vector<double>>& fallback);
  [[nodiscard]] std::vector<std::string> texts(std::string_view key,
                                               const std::optional<std::vector<std::string>>& fallback);
  [[nodiscard]] std::vector<std::string> choices(std::string_view key, Words allowed,
                                                 const std::optional<std::vector<std::string>>& fallback);
  /// A number in `range`, or nothing for the word `word`; `fallback` when the key is missing.
  [[nodiscard]] std::optional<double> number_or(std::string_view key, const NumberRange& range, std::string_view word,
                                                std::optional<double> fallback);
  /// A number in `range`, or nothing when the key is missing.
  [[nodiscard]] std::optional<double> optional_number(std::string_view key, const NumberRange& range);
  /// A table whose keys are free, values as text: settings of a camera. Numbers and booleans become the text TOML
  /// writes for them.
  [[nodiscard]] std::map<std::string, std::string> free_table(std::string_view key);

  /// A sub-table; absent: an empty one, all of whose keys are missing.
  [[nodiscard]] TomlReader section(std::string_view key);
  /// An array of tables ([[key]]); absent: none.
  [[nodiscard]] std::vector<TomlReader> sections(std::string_view key);

  [[nodiscard]] bool has(std::string_view key) const;
  /// False for section() of a table that the file does not have.
  [[nodiscard]] bool present() const;

  /// Records a mistake at a key of this table, or at element `index` of its list: "FILE:LINE: key 'KEY' in [SECTION]:
  /// SENTENCE".
  void reject(std::string_view key, const std::string& sentence);
  void reject(std::string_view key, std::size_t index, const std::string& sentence);

  /// Success when nothing was wrong and every key of the document was asked for. Otherwise the first mistake in the
  /// order of lines, unknown keys before missing ones (a misspelt key is usually both), `invalid_input` with its key.
  /// Covers the whole document, whichever reader it is called on.
  [[nodiscard]] Result<void> finish() const;

 private:
  struct Document;
  struct Table;
  TomlReader(std::shared_ptr<Document> document, Table* table) : document_(std::move(document)), table_(table) {}
  std::shared_ptr<Document> document_;
  Table* table_;  ///< owned by the document
};

}  // namespace todbench
