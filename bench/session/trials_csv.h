// SPDX-License-Identifier: GPL-3.0-or-later
// Trials and counts as CSV (RFC 4180, dot decimal, UTF-8, header with units).
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/text/files.h"
#include "tod/presentation/trial.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Writes trials as they occur. append() passes each trial to the operating system before it returns. One thread at a
/// time.
class TrialsWriter {
 public:
  /// Creates the file with its header. Errors: `io` with the path.
  [[nodiscard]] static Result<TrialsWriter> create(const std::filesystem::path& file);
  /// Appends a trial. Errors: `io` with the path (the file then ends with the previous trial); `internal` (non-finite
  /// number or name with a line end, which a measurement never produces).
  [[nodiscard]] Result<void> append(const Trial& trial);
  /// Waits until all data are on the disk.
  [[nodiscard]] Result<void> sync() { return file_.sync(); }

 private:
  explicit TrialsWriter(AppendFile file) : file_(std::move(file)) {}
  AppendFile file_;
};

/// Reads a file that TrialsWriter wrote. Numbers are read back exactly. An unknown since_nuc_s is an empty field. Files
/// of earlier versions lack the last columns. Missing columns are read as 0 saturated pixels, no probability_correct,
/// one frame, and no position in the picture. Errors: `invalid_input` "FILE:LINE: ..." for any other content.
[[nodiscard]] Result<std::vector<Trial>> read_trials(const std::filesystem::path& file);

/// Reads counts for one psychometric fit: columns size, correct, total and optionally cluster (whole number >= 0), in
/// any order. A file with only a header is empty data, not an error. Errors: `invalid_input` "FILE:LINE: ..." (missing,
/// repeated or unknown column, row of a wrong length, negative or non-finite size, count negative or not whole, correct
/// > total).
[[nodiscard]] Result<std::vector<Level>> read_levels(const std::filesystem::path& file);
/// Parses counts in the same format from text. `name`: name of the text in messages.
[[nodiscard]] Result<std::vector<Level>> parse_levels(std::string_view text, std::string_view name);

}  // namespace todbench
