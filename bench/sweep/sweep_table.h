// All results of a sweep as one table, and what can be read from it.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bench/sweep/result_store.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// One row for each task and contrast, in the order of the indices; no times and no hosts, so that the table is the
/// same bytes however it was run.
struct SweepTable {
  std::vector<std::string> columns;  ///< index, task, the parameters, repeat, seed, then the numbers of a point
  std::vector<Json> rows;            ///< each a list as long as the columns; numbers, texts or null
  std::string version, commit;
  std::size_t tasks = 0, missing = 0;
};
/// `invalid_input`: results of another sweep, of several versions of the program (the first two are named), a result
/// that cannot be read. `not_identifiable`: tasks are missing, and not allowed to.
enum class MissingTasks { refused, left_out };
[[nodiscard]] Result<SweepTable> collected(const Sweep& sweep, MissingTasks missing);

[[nodiscard]] std::string to_csv(const SweepTable& table);
/// {"columns", "rows", "tasks", "missing"}.
[[nodiscard]] Json to_json(const SweepTable& table);
/// Table `results` of a new SQLite file, which is written beside and renamed. `io` with the path.
[[nodiscard]] Result<void> write_sqlite(const SweepTable& table, const std::filesystem::path& file);

}  // namespace todbench
