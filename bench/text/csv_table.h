// A CSV file as rows of fields with their line numbers.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"

namespace todbench {

struct CsvRow {
  int line = 0;  ///< counted from 1, header included
  std::vector<std::string> fields;
};

struct CsvTable {
  std::string name;  ///< what messages call it
  std::vector<std::string> header;
  std::vector<CsvRow> rows;

  /// "NAME:LINE: SENTENCE" as an error `invalid_input`.
  [[nodiscard]] tl::unexpected<Error> wrong(int line, const std::string& sentence) const;
};

/// Splits a whole file; lines may end with CR LF, empty lines are skipped, blanks round fields without quotes are not
/// kept. `invalid_input` with the line: no header, a row with another number of fields than the header, misplaced
/// quotes.
[[nodiscard]] Result<CsvTable> parse_csv(std::string_view text, std::string_view name);

}  // namespace todbench
