#include "acquisition/recording/written_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "acquisition/core/system_reason.h"

namespace todbench {
Result<WrittenFile> WrittenFile::create(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (descriptor < 0) return fail(ErrorCode::io, path.string() + ": cannot be created: " + system_reason());
  return WrittenFile(path, descriptor);
}

WrittenFile::WrittenFile(WrittenFile&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)), bytes_(other.bytes_) {}

WrittenFile& WrittenFile::operator=(WrittenFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(bytes_, other.bytes_);
  return *this;
}

WrittenFile::~WrittenFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<void> WrittenFile::failed(const std::string& why) const {
  return fail(ErrorCode::io, path_.string() + ": " + why);
}

Result<void> WrittenFile::append(const void* data, std::size_t bytes) {
  const auto* at = static_cast<const char*>(data);
  while (bytes > 0) {
    const ssize_t done = ::write(descriptor_, at, bytes);
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
    const ssize_t done = ::pwrite(descriptor_, at, bytes, static_cast<off_t>(offset));
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return failed(done < 0 ? system_reason() : "the disk is full");
    at += done;
    offset += static_cast<std::uint64_t>(done);
    bytes -= static_cast<std::size_t>(done);
  }
  return {};
}

void WrittenFile::cut(std::uint64_t bytes) {
  if (::ftruncate(descriptor_, static_cast<off_t>(bytes)) == 0 &&
      ::lseek(descriptor_, static_cast<off_t>(bytes), SEEK_SET) >= 0) {
    bytes_ = bytes;
  }
}

Result<void> WrittenFile::check_present() const {
  struct stat facts {};
  if (::fstat(descriptor_, &facts) != 0) return failed(system_reason());
  if (facts.st_nlink == 0) return failed("was deleted while it was written");
  return {};
}

Result<void> WrittenFile::sync() const {
  if (::fsync(descriptor_) != 0) return failed(system_reason());
  const auto parent = path_.has_parent_path() ? path_.parent_path() : std::filesystem::path(".");
  const int folder = ::open(parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder >= 0) {
    // File systems that cannot do this for a folder do not need it.
    static_cast<void>(::fsync(folder));
    ::close(folder);
  }
  if (auto present = check_present(); !present) return present;
  struct stat mine {
  }, there{};
  if (::fstat(descriptor_, &mine) != 0) return failed(system_reason());
  if (::stat(path_.c_str(), &there) != 0) return failed("is not there any more: " + system_reason());
  if (mine.st_dev != there.st_dev || mine.st_ino != there.st_ino) {
    return failed("another file is in the place of the one that was written");
  }
  if (static_cast<std::uint64_t>(there.st_size) != bytes_) {
    return failed("has " + std::to_string(there.st_size) + " bytes, and " + std::to_string(bytes_) + " were written");
  }
  return {};
}

}  // namespace todbench
