// A file that is being written and must be on the disk when it is said to be. Private to the recordings.
#pragma once

#include <cstdint>
#include <filesystem>

#include "acquisition/core/result.h"

namespace todbench {

/// Owns the descriptor. Move-only. Every error is `io` with the path.
class WrittenFile {
 public:
  /// Creates the file or empties it.
  [[nodiscard]] static Result<WrittenFile> create(const std::filesystem::path& path);
  WrittenFile(WrittenFile&& other) noexcept;
  WrittenFile& operator=(WrittenFile&& other) noexcept;
  ~WrittenFile();

  /// Writes at the end. A part of it may be in the file when it fails.
  [[nodiscard]] Result<void> append(const void* data, std::size_t bytes);
  /// Writes over what is there.
  [[nodiscard]] Result<void> overwrite(std::uint64_t offset, const void* data, std::size_t bytes);
  /// Takes back what is behind the first `bytes`, as far as the disk allows.
  void cut(std::uint64_t bytes);
  /// Fails when the file was deleted: what is written then is in no folder and gone with the program.
  [[nodiscard]] Result<void> check_present() const;
  /// Waits until everything is on the disk, and fails unless the path still leads to it.
  [[nodiscard]] Result<void> sync() const;

  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  WrittenFile(std::filesystem::path path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {}
  [[nodiscard]] Result<void> failed(const std::string& why) const;

  std::filesystem::path path_;
  int descriptor_ = -1;
  std::uint64_t bytes_ = 0;
};

}  // namespace todbench
