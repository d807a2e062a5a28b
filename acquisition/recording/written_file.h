// SPDX-License-Identifier: GPL-3.0-or-later
// A file that is being written, with checks that it reaches the disk. Private to the recordings.
#pragma once

#include <cstdint>
#include <filesystem>

#include "acquisition/base/descriptor.h"
#include "acquisition/base/result.h"

namespace todbench {

/// A file and its descriptor. Move-only. Every error is `io` with the path.
class WrittenFile {
 public:
  /// Creates the file. Replaces an existing file; does not follow a link.
  [[nodiscard]] static Result<WrittenFile> create(const std::filesystem::path& path);

  /// Writes at the end. After a failure part of the data may be in the file.
  [[nodiscard]] Result<void> append(const void* data, std::size_t bytes);
  /// Overwrites existing bytes.
  [[nodiscard]] Result<void> overwrite(std::uint64_t offset, const void* data, std::size_t bytes);
  /// Truncates the file to `bytes`. Ignores a failure of the disk.
  void cut(std::uint64_t bytes);
  /// Fails if the file was deleted: further data would be lost at the end of the program.
  [[nodiscard]] Result<void> check_present() const;
  /// Waits until everything is on the disk. Fails if the path no longer leads to this file.
  [[nodiscard]] Result<void> sync() const;

  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  WrittenFile(std::filesystem::path path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {}
  [[nodiscard]] Result<void> failed(const std::string& why) const;

  std::filesystem::path path_;
  Descriptor descriptor_;
  std::uint64_t bytes_ = 0;
};

}  // namespace todbench
