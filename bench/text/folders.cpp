// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/text/folders.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>

#include "acquisition/base/descriptor.h"
#include "acquisition/base/system_reason.h"

namespace todbench {

ErrorCode code_of_path(const std::error_code& problem) {
  for (const std::errc of_the_path : {std::errc::not_a_directory, std::errc::file_exists, std::errc::is_a_directory,
                                      std::errc::filename_too_long, std::errc::too_many_symbolic_link_levels}) {
    if (problem == of_the_path) return ErrorCode::invalid_input;
  }
  return ErrorCode::io;
}

Result<void> make_folder(const std::filesystem::path& folder) {
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (problem) return fail(code_of_path(problem), folder.string() + ": cannot be created: " + problem.message());
  if (::access(folder.c_str(), W_OK | X_OK) == 0) return {};
  return fail(ErrorCode::io, folder.string() + ": cannot be written to: " + system_reason());
}

class FolderClaim {
 public:
  explicit FolderClaim(int descriptor) : descriptor_(descriptor) {}

 private:
  Descriptor descriptor_;
};

Result<std::shared_ptr<const FolderClaim>> claim_folder(const std::filesystem::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  auto claim = std::make_shared<const FolderClaim>(descriptor);
  if (descriptor >= 0 && ::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
    return fail(ErrorCode::invalid_input, folder.string() + ": another program is writing into this folder");
  return claim;
}

std::string picture_name(std::size_t number) {
  return fmt::format("{:04}.png", number);
}

}  // namespace todbench
