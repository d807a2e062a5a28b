// Files that are either whole or not there, and checksums.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "acquisition/core/result.h"

namespace todbench {

/// Writes beside the file, syncs and renames over it: a reader sees the old or the new content, never a part. `io` with
/// the path and the reason (disk full, access denied); the old file is then still there.
[[nodiscard]] Result<void> write_file_atomically(const std::filesystem::path& file, std::string_view content);

/// Whether something has that path; false as well where the path cannot be looked up.
[[nodiscard]] bool is_there(const std::filesystem::path& file);

/// SHA-256 of a text in lower-case hexadecimal.
[[nodiscard]] std::string sha256_of(std::string_view text);
/// SHA-256 of a file in lower-case hexadecimal, read in pieces. `io` when it cannot be read.
[[nodiscard]] Result<std::string> sha256_of_file(const std::filesystem::path& file);

/// A file that only grows. Every write is checked and goes to the system at once, so that a crash of the program loses
/// nothing that was appended. Move-only; one thread at a time.
class AppendFile {
 public:
  enum class Start { empty, at_end };
  /// Creates the file or, at_end, continues it. `io` with path and reason.
  [[nodiscard]] static Result<AppendFile> open(const std::filesystem::path& file, Start start);
  AppendFile(AppendFile&& other) noexcept;
  AppendFile& operator=(AppendFile&& other) noexcept;
  ~AppendFile();

  /// Appends all of `content`, or nothing: what a full disk cut off is taken back. `io` with path and reason.
  [[nodiscard]] Result<void> append(std::string_view content);
  /// Waits until the data are on the disk.
  [[nodiscard]] Result<void> sync();
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  AppendFile(std::filesystem::path path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {}
  std::filesystem::path path_;
  int descriptor_ = -1;
};

}  // namespace todbench
