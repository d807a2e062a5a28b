// SPDX-License-Identifier: GPL-3.0-or-later
// Atomic file writes, append-only files and checksums.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "acquisition/base/descriptor.h"
#include "acquisition/base/result.h"

namespace todbench {

/// Writes a temporary file in the same folder, syncs it and renames it: readers find the old or the new content, never
/// a part. Errors: `io` with path and reason (disk full, access denied), `invalid_input` (the path is a pipe, a socket
/// or a device); what was there then remains.
[[nodiscard]] Result<void> write_file_atomically(const std::filesystem::path& file, std::string_view content);

/// Returns whether the path exists; false also if it cannot be looked up.
[[nodiscard]] bool is_there(const std::filesystem::path& file);

/// Returns the SHA-256 of a text in lower-case hexadecimal.
[[nodiscard]] std::string sha256_of(std::string_view text);
/// Returns the SHA-256 of a file in lower-case hexadecimal; reads it in pieces. Errors: `io` (unreadable).
[[nodiscard]] Result<std::string> sha256_of_file(const std::filesystem::path& file);

/// Append-only file. Every write is checked and passed to the operating system immediately. A crash of the program
/// therefore loses no appended data. Move-only; one thread at a time.
class AppendFile {
 public:
  /// Content of the file at the beginning: emptied, or continued.
  enum class Start { empty, at_end };
  /// Creates the file, or continues it with Start::at_end. Errors: `io` with path and reason.
  [[nodiscard]] static Result<AppendFile> open(const std::filesystem::path& file, Start start);

  /// Appends all of `content`; truncates a partial write on a full disk. Errors: `io` with path and reason.
  [[nodiscard]] Result<void> append(std::string_view content);
  /// Waits until the data are on the disk.
  [[nodiscard]] Result<void> sync();
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  AppendFile(std::filesystem::path path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {}
  std::filesystem::path path_;
  Descriptor descriptor_;
};

}  // namespace todbench
