// SPDX-License-Identifier: GPL-3.0-or-later
// All results of a sweep as one table, and its output formats.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bench/sweep/result_store.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// One row for each task and contrast, in the order of the indices. The table contains no times and no host names. Its
/// bytes therefore do not depend on the way in which the sweep was run.
struct SweepTable {
  std::vector<std::string> columns;  ///< index, task, the parameters, repeat, seed, then the numbers of a point
  std::vector<Json> rows;            ///< each a list as long as the columns; numbers, texts or null
  std::string version, commit;
  std::size_t tasks = 0, missing = 0;
};
/// Treatment of tasks without a result.
enum class MissingTasks { refused, left_out };
/// Collects all results. Errors: `invalid_input` (results of a different sweep; results of several versions of the
/// program, of which the message names two; an unreadable result), `not_identifiable` (tasks are missing and
/// MissingTasks::refused).
[[nodiscard]] Result<SweepTable> collected(const Sweep& sweep, MissingTasks missing);

/// Returns the table as CSV.
[[nodiscard]] std::string to_csv(const SweepTable& table);
/// Returns {"columns", "rows", "tasks", "missing"}.
[[nodiscard]] Json to_json(const SweepTable& table);
/// Writes table `results` to a new SQLite file, via a temporary file and renaming. Errors: `io` with the path.
[[nodiscard]] Result<void> write_sqlite(const SweepTable& table, const std::filesystem::path& file);

}  // namespace todbench
