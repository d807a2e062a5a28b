// SPDX-License-Identifier: GPL-3.0-or-later
// CSV file as rows of fields with line numbers.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// One row.
struct CsvRow {
  int line = 0;  ///< from 1, including the header
  std::vector<std::string> fields;
};

/// Rows of a file, with their header.
struct CsvTable {
  std::string name;  ///< name in messages
  std::vector<std::string> header;
  std::vector<CsvRow> rows;

  /// Returns the position of the first column of this name; empty if there is none.
  [[nodiscard]] std::optional<std::size_t> column(std::string_view of) const;
  /// Returns the error `invalid_input` "NAME:LINE: SENTENCE".
  [[nodiscard]] tl::unexpected<Error> wrong(int line, const std::string& sentence) const;
};

/// Parses a whole file. Lines may end with CR LF, empty lines are skipped, blanks around unquoted fields are removed.
/// Errors: `invalid_input` with the line (no header, a number of fields that differs from the header, misplaced
/// quotes).
[[nodiscard]] Result<CsvTable> parse_csv(std::string_view text, std::string_view name);

}  // namespace todbench
