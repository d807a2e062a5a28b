// What the program says: tables and JSON on standard output, progress and notes on standard error.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"
#include "bench/session/json_output.h"

namespace todbench {

struct ConsoleOptions {
  bool json = false;   ///< exactly one JSON object on standard output, nothing else there
  bool quiet = false;  ///< no progress and no notes
};

/// Columns of a table are aligned; numbers are text already.
using TableRow = std::vector<std::string>;

/// Where text goes to a terminal: whatever it holds comes out as valid_text(). One thread at a time.
class Console {
 public:
  explicit Console(ConsoleOptions options);

  [[nodiscard]] bool json() const { return options_.json; }
  /// The one JSON object of the run.
  void object(const Json& json) const;
  /// Text for people on standard output, broken at words where that is a terminal; nothing with --json.
  void text(std::string_view line) const;
  /// A header and rows, as table_lines() lays them out for the terminal. A table longer than it goes through $PAGER
  /// (less).
  void table(const TableRow& header, const std::vector<TableRow>& rows) const;
  /// A sentence on standard error; nothing with --quiet.
  void note(std::string_view sentence);
  /// A sentence on standard error, always: without it what the program says next would be taken for more than it is.
  void warning(std::string_view sentence);
  /// An error on standard error, always, on one line.
  void error(std::string_view sentence);
  /// Begins a phase of work; progress() then draws a bar with the time left where standard error is a terminal.
  void phase(std::string_view name);
  void progress(std::size_t done, std::size_t planned);
  /// What the run waits for: in place of the bar on a terminal, elsewhere a line now and again.
  void waiting(std::string_view sentence);
  /// Lines that are drawn over when they are shown again and nothing was said in between; terminals only.
  void picture(const std::vector<std::string>& lines);
  /// Notes and progress go to somebody: a terminal, or a file or pipe.
  enum class Audience { nobody, terminal, lines };
  [[nodiscard]] Audience audience() const;
  /// Letters of a line of the terminal; 80 where it does not say.
  [[nodiscard]] std::size_t columns() const;
  /// Removes the bar.
  void end_progress();

 private:
  ConsoleOptions options_;
  bool terminal_ = false;
  bool colour_ = false;
  bool bar_shown_ = false;
  std::size_t picture_lines_ = 0;  ///< just above the cursor's line
  std::chrono::steady_clock::time_point last_waiting_;
  std::string phase_;
  std::chrono::steady_clock::time_point phase_start_;
  std::chrono::steady_clock::time_point last_draw_;
};

/// The lines of a text with their ends, for standard output or standard error: broken at words where that is a
/// terminal, which would break them anywhere.
[[nodiscard]] std::string broken_for(int descriptor, std::string_view text);

/// What was written to standard output reached it: `io` when it is full or closed.
[[nodiscard]] Result<void> finish_output();

/// "0.480", "–" for a missing number, "1.2e-08" where the decimals would show nothing of it.
[[nodiscard]] std::string fixed(const std::optional<double>& value, int decimals);
/// "0.468 … 0.493", with an open side as –.
[[nodiscard]] std::string range(const Interval& interval, int decimals);

}  // namespace todbench
