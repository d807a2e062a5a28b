// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/recording/written_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "acquisition/base/safe_file.h"
#include "acquisition/base/system_reason.h"
#include "acquisition/base/try.h"

namespace todbench {
Result<WrittenFile> WrittenFile::create(const std::filesystem::path& path) {
  TODBENCH_TRY(const auto descriptor, make_empty_file(path, 0644));
  return WrittenFile(path, descriptor);
}

Result<void> WrittenFile::failed(const std::string& why) const {
  return fail(ErrorCode::io, path_.string() + ": " + why);
}

Result<void> WrittenFile::append(const void* data, std::size_t bytes) {
  const auto* at = static_cast<const char*>(data);
  while (bytes > 0) {
    const ssize_t done = ::write(descriptor_.get(), at, bytes);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return failed(done < 0 ? system_reason() : "the disk is full");
    at += done;
    bytes -= static_cast<std::size_t>(done);
    bytes_ += static_cast<std::uint64_t>(done);
  }
  return {};
}

Result<void> WrittenFile::overwrite(std::uint64_t offset, const void* data, std::size_t bytes) {
  const auto* at = static_cast<const char*>(data);
  while (bytes > 0) {
    const ssize_t done = ::pwrite(descriptor_.get(), at, bytes, static_cast<off_t>(offset));
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return failed(done < 0 ? system_reason() : "the disk is full");
    at += done;
    offset += static_cast<std::uint64_t>(done);
    bytes -= static_cast<std::size_t>(done);
  }
  return {};
}

void WrittenFile::cut(std::uint64_t bytes) {
  if (::ftruncate(descriptor_.get(), static_cast<off_t>(bytes)) == 0 &&
      ::lseek(descriptor_.get(), static_cast<off_t>(bytes), SEEK_SET) >= 0) {
    bytes_ = bytes;
  }
}

Result<void> WrittenFile::check_present() const {
  struct stat facts {};
  if (::fstat(descriptor_.get(), &facts) != 0) return failed(system_reason());
  if (facts.st_nlink == 0) return failed("the file was deleted while it was written");
  return {};
}

Result<void> WrittenFile::sync() const {
  if (::fsync(descriptor_.get()) != 0) return failed(system_reason());
  const auto parent = path_.has_parent_path() ? path_.parent_path() : std::filesystem::path(".");
  const int folder = ::open(parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder >= 0) {
    // File systems that cannot sync a folder do not need it.
    static_cast<void>(::fsync(folder));
    ::close(folder);
  }
  TODBENCH_TRY_VOID(check_present());
  struct stat mine {
  }, there{};
  if (::fstat(descriptor_.get(), &mine) != 0) return failed(system_reason());
  if (::stat(path_.c_str(), &there) != 0) return failed("the file no longer exists: " + system_reason());
  if (mine.st_dev != there.st_dev || mine.st_ino != there.st_ino) {
    return failed("another file replaced the one that was written");
  }
  if (static_cast<std::uint64_t>(there.st_size) != bytes_) {
    return failed("the file has " + std::to_string(there.st_size) + " bytes, but " + std::to_string(bytes_) +
                  " were written");
  }
  return {};
}

}  // namespace todbench
