// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/base/safe_file.h"

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>
#include <system_error>

#include "acquisition/base/system_reason.h"
#include "acquisition/base/try.h"

namespace todbench {
namespace {

constexpr std::string_view part_ending = ".part";
constexpr std::size_t random_digits = 16;
/// Collisions of 64 random bits do not happen by chance; a process that reads the source of randomness might force
/// some.
constexpr int attempts = 16;
/// NAME_MAX less the dot, the random digits and the suffix.
constexpr std::size_t longest_kept_name = 255 - 2 - random_digits - part_ending.size();

tl::unexpected<Error> refused(const std::filesystem::path& file, std::string_view doing, const std::string& reason) {
  return fail(ErrorCode::io, file.string() + ": " + std::string(doing) + ": " + reason);
}

/// What a path is that exists and is not a regular file.
std::string other_than_file(bool folder) {
  return folder ? "it is a folder" : "it is a pipe, a socket or a device";
}

/// Empty if the system has no random bits.
std::string random_text() {
  std::uint64_t bits = 0;
  if (::getrandom(&bits, sizeof bits, 0) != static_cast<ssize_t>(sizeof bits)) return {};
  std::array<char, random_digits + 1> text{};
  std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(bits));
  return text.data();
}

bool is_of_the_system(const std::filesystem::path& file) {
  const std::string name = file.lexically_normal().string();
  return name.starts_with("/dev/") || name.starts_with("/proc/");
}

}  // namespace

Result<NewFile> make_file_beside(const std::filesystem::path& file, mode_t mode) {
  const std::string kept = file.filename().string().substr(0, longest_kept_name);
  for (int i = 0; i < attempts; ++i) {
    const std::string random = random_text();
    if (random.empty()) return refused(file, "cannot be created", system_reason());
    std::string name = ".";
    name += kept;
    name += ".";
    name += random;
    name += part_ending;
    auto path = file.parent_path() / name;
    const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode);
    if (descriptor >= 0) return NewFile{descriptor, std::move(path)};
    if (errno != EEXIST) break;
  }
  return refused(file, "cannot be created", system_reason());
}

bool is_name_of_a_part(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  if (!name.starts_with('.') || !name.ends_with(part_ending)) return false;
  const std::size_t end = name.size() - part_ending.size();
  if (end < random_digits + 2 || name[end - random_digits - 1] != '.') return false;
  return name.find_first_not_of("0123456789abcdef", end - random_digits) == end;
}

Result<int> make_empty_file(const std::filesystem::path& file, mode_t mode) {
  // Links below /dev and /proc belong to the system: /dev/stdout, /proc/self/fd/3.
  if (is_of_the_system(file)) {
    const int descriptor = ::open(file.c_str(), O_RDWR | O_TRUNC | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (descriptor < 0) return refused(file, "cannot be opened", system_reason());
    return descriptor;
  }
  struct ::stat found {};
  if (::lstat(file.c_str(), &found) == 0 && !S_ISREG(found.st_mode) && !S_ISLNK(found.st_mode)) {
    if (!S_ISCHR(found.st_mode)) return refused(file, "cannot be created", "the path exists and is not a regular file");
    const int device = ::open(file.c_str(), O_RDWR | O_NOFOLLOW | O_NOCTTY | O_CLOEXEC);
    if (device < 0) return refused(file, "cannot be opened", system_reason());
    return device;
  }
  TODBENCH_TRY(auto made, make_file_beside(file, mode));
  if (::rename(made.path.c_str(), file.c_str()) == 0) return made.descriptor;
  const std::string reason = system_reason();
  ::unlink(made.path.c_str());
  ::close(made.descriptor);
  return refused(file, "cannot be created", reason);
}

Result<int> open_to_append(const std::filesystem::path& file) {
  // Without O_NONBLOCK a pipe without a reader would block the program.
  const int descriptor =
      ::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    return refused(file, "cannot be created",
                   errno == ELOOP   ? "it is a symbolic link"
                   : errno == ENXIO ? "the path exists and is not a regular file"
                                    : system_reason());
  }
  struct ::stat found {};
  if (::fstat(descriptor, &found) == 0 && (S_ISREG(found.st_mode) || S_ISCHR(found.st_mode))) return descriptor;
  ::close(descriptor);
  return refused(file, "cannot be written", "the path exists and is not a regular file");
}

Result<int> open_to_read(const std::filesystem::path& file) {
  const bool may_wait = is_of_the_system(file);
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY | (may_wait ? 0 : O_NONBLOCK));
  if (descriptor < 0) return refused(file, "cannot be opened for reading", system_reason());
  struct ::stat found {};
  if (may_wait || (::fstat(descriptor, &found) == 0 && S_ISREG(found.st_mode))) return descriptor;
  ::close(descriptor);
  return refused(file, "cannot be opened for reading", other_than_file(S_ISDIR(found.st_mode)));
}

std::string no_file_reason(const std::filesystem::path& file) {
  std::error_code problem;
  const auto status = std::filesystem::status(file, problem);
  return std::filesystem::exists(status) ? other_than_file(std::filesystem::is_directory(status)) : "no such file";
}

int write_all(int descriptor, std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = ::write(descriptor, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    if (written == 0) return ENOSPC;
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

}  // namespace todbench
