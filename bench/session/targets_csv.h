// SPDX-License-Identifier: GPL-3.0-or-later
// Target read-back of every presentation as CSV (RFC 4180, dot decimal, UTF-8, header with units).
#pragma once

#include <filesystem>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/text/files.h"
#include "tod/presentation/presentation.h"

namespace todbench {

/// Writes presentations as they occur. append() passes each presentation to the operating system before it returns. One
/// thread at a time.
class TargetsWriter {
 public:
  /// Creates the file with its header. Errors: `io` with the path.
  [[nodiscard]] static Result<TargetsWriter> create(const std::filesystem::path& file);
  /// Appends a presentation. A non-finite number from an instrument becomes an empty field. Errors: `io` with the path
  /// (the file then ends with the previous row); `internal` (non-finite set-point or name with a line end, which a
  /// measurement never produces).
  [[nodiscard]] Result<void> append(const Presentation& presentation);
  /// Waits until all data are on the disk.
  [[nodiscard]] Result<void> sync() { return file_.sync(); }

 private:
  explicit TargetsWriter(AppendFile file) : file_(std::move(file)) {}
  AppendFile file_;
};

/// Reads a file that TargetsWriter wrote. Numbers are read back exactly. Errors: `invalid_input` "FILE:LINE: ..." for
/// any other content.
[[nodiscard]] Result<std::vector<Presentation>> read_targets(const std::filesystem::path& file);

}  // namespace todbench
