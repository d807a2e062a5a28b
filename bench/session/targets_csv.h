// What the target said at every presentation, as CSV (RFC 4180, dot decimal, UTF-8, a header with units).
#pragma once

#include <filesystem>
#include <vector>

#include "acquisition/core/result.h"
#include "bench/text/files.h"
#include "tod/presentation/presentation.h"

namespace todbench {

/// Writes presentations as they happen: each is handed to the system before append() returns. One thread at a time.
class TargetsWriter {
 public:
  /// Creates the file with its header. `io` with the path.
  [[nodiscard]] static Result<TargetsWriter> create(const std::filesystem::path& file);
  /// `io` with the path when the disk refuses (the file then ends with the row before); `internal` for a set-point that
  /// is not finite or a name with a line end, neither of which a measurement produces. A number that an instrument
  /// says and that is not finite is an empty field.
  [[nodiscard]] Result<void> append(const Presentation& presentation);
  /// Waits until everything is on the disk.
  [[nodiscard]] Result<void> sync() { return file_.sync(); }

 private:
  explicit TargetsWriter(AppendFile file) : file_(std::move(file)) {}
  AppendFile file_;
};

/// Reads what TargetsWriter wrote, every number exactly as it was. `invalid_input` "FILE:LINE: ..." for anything else
/// than such a file.
[[nodiscard]] Result<std::vector<Presentation>> read_targets(const std::filesystem::path& file);

}  // namespace todbench
