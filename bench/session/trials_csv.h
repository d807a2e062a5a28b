// Trials and counts as CSV (RFC 4180, dot decimal, UTF-8, a header with units).
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"
#include "bench/text/files.h"
#include "tod/presentation/trial.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Writes trials as they happen: each is handed to the system before append() returns. One thread at a time.
class TrialsWriter {
 public:
  /// Creates the file with its header. `io` with the path.
  [[nodiscard]] static Result<TrialsWriter> create(const std::filesystem::path& file);
  /// `io` with the path when the disk refuses (the file then ends with the trial before); `internal` for a number that
  /// is not finite or a name with a line end, neither of which a measurement produces.
  [[nodiscard]] Result<void> append(const Trial& trial);
  /// Waits until everything is on the disk.
  [[nodiscard]] Result<void> sync() { return file_.sync(); }

 private:
  explicit TrialsWriter(AppendFile file) : file_(std::move(file)) {}
  AppendFile file_;
};

/// Reads what TrialsWriter wrote, every number exactly as it was. A since_nuc_s that is not known is an empty field.
/// A file without its last columns is one of an earlier version: without saturated_pixels, which it did not count, they
/// are 0; without probability_correct and frames there is no probability and one frame; without its
/// place in the picture a triangle has none.
/// `invalid_input` "FILE:LINE: ..." for anything else than such a file.
[[nodiscard]] Result<std::vector<Trial>> read_trials(const std::filesystem::path& file);

/// Counts for one psychometric fit: columns size, correct, total and optionally cluster (whole number >= 0), in any
/// order. `invalid_input` "FILE:LINE: ..." for a missing, repeated or unknown column, rows of another length, negative
/// or non-finite sizes, counts that are not whole or negative, correct > total. A file with a header only is no data,
/// not an error.
[[nodiscard]] Result<std::vector<Level>> read_levels(const std::filesystem::path& file);
/// The same from text; `name` is what messages call it.
[[nodiscard]] Result<std::vector<Level>> parse_levels(std::string_view text, std::string_view name);

}  // namespace todbench
