// SPDX-License-Identifier: GPL-3.0-or-later
// Output of the program: tables and JSON on standard output, progress and notes on standard error.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/session/json_output.h"
#include "bench/text/time_left.h"

namespace todbench {

/// Output options.
struct ConsoleOptions {
  bool json = false;   ///< standard output contains exactly one JSON object and no other text
  bool quiet = false;  ///< no progress and no notes
};

/// Cells of one line. table() aligns the columns; numbers are passed as text.
using TableRow = std::vector<std::string>;

/// Output to a terminal. Every text passes valid_text(). One thread at a time.
class Console {
 public:
  explicit Console(ConsoleOptions options);

  /// Returns whether the output is JSON.
  [[nodiscard]] bool json() const { return options_.json; }
  /// Writes the only JSON object of the run to standard output.
  void object(const Json& json) const;
  /// Writes text for people to standard output, wrapped at words on a terminal; no output with --json.
  void text(std::string_view line) const;
  /// Writes a header and rows, laid out by table_lines(). A table longer than the terminal goes through $PAGER
  /// (default: less).
  void table(const TableRow& header, const std::vector<TableRow>& rows) const;
  /// Writes a sentence to standard error; no output with --quiet.
  void note(std::string_view sentence);
  /// Writes a sentence to standard error, also with --quiet, because a reader could misinterpret the following output
  /// without this sentence.
  void warning(std::string_view sentence);
  /// Writes an error to standard error on one line, also with --quiet.
  void error(std::string_view sentence);
  /// Starts a phase of work. progress() then shows the remaining time: in a bar if standard error is a terminal,
  /// otherwise in one line per minute.
  void phase(std::string_view name);
  /// Shows the progress of the phase.
  void progress(std::size_t done, std::size_t planned);
  /// Call this function when the work stops advancing. The estimate of the remaining time then excludes the time until
  /// the next progress().
  void stands_still();
  /// Shows why the run waits: in place of the bar on a terminal, otherwise as an occasional line.
  void waiting(std::string_view sentence);
  /// Draws lines on a terminal; no output elsewhere. Overwrites the previous picture if no other output followed it.
  void picture(const std::vector<std::string>& lines);
  /// Receiver of notes and progress: none, a terminal, or a file or pipe.
  enum class Audience { nobody, terminal, lines };
  /// Returns the receiver.
  [[nodiscard]] Audience audience() const;
  /// Returns the number of columns of the terminal; 80 if unknown.
  [[nodiscard]] std::size_t columns() const;
  /// Removes the bar.
  void end_progress();

 private:
  ConsoleOptions options_;
  bool terminal_ = false;
  bool colour_ = false;
  bool bar_shown_ = false;
  std::size_t picture_lines_ = 0;  ///< directly above the line of the cursor
  std::chrono::steady_clock::time_point last_waiting_;
  std::string phase_;
  TimeLeft time_left_;
  std::chrono::steady_clock::time_point last_draw_;
};

/// Returns a text with line ends for output to `descriptor` (standard output or standard error). Wraps it at words if
/// the descriptor is a terminal.
[[nodiscard]] std::string broken_for(int descriptor, std::string_view text);

/// Flushes standard output. Errors: `io` if the output is full or closed.
[[nodiscard]] Result<void> finish_output();

/// Returns "0.480"; "–" for a missing number; "1.2e-08" if all decimals would be zero.
[[nodiscard]] std::string fixed(const std::optional<double>& value, int decimals);
/// Returns "0.468 … 0.493"; an open limit is shown as –.
[[nodiscard]] std::string range(const Interval& interval, int decimals);

}  // namespace todbench
