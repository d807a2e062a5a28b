// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/ending_reserve.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string>
#include <system_error>

namespace todbench {
namespace {

struct Piece {
  EndingRoom room;
  const char* name;
  off_t bytes;
};
// A manifest needs about 200 bytes for each of about twenty files. Provenance and verdict need 8 KiB together and are
// written next to their earlier versions. Results may exceed their reserve, and a report always does; files that do not
// fit are left out. The reserves are separate files, because a file size limit may be smaller than their sum.
constexpr std::array pieces{Piece{EndingRoom::manifest, ".room-for-manifest", 8 * 1024},
                            Piece{EndingRoom::state, ".room-for-state", 16 * 1024},
                            Piece{EndingRoom::results, ".room-for-results-1", 16 * 1024},
                            Piece{EndingRoom::results, ".room-for-results-2", 16 * 1024}};

/// Returns 0 or the error number.
int take(const std::filesystem::path& file, off_t bytes) {
  // Not make_empty_file(): the reserve has its name from the start, so that an abandoned one is found.
  ::unlink(file.c_str());
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (descriptor < 0) return errno;
  const int problem = ::posix_fallocate(descriptor, 0, bytes);
  return ::close(descriptor) != 0 && problem == 0 ? errno : problem;
}

}  // namespace

Result<void> take_ending_rooms(const std::filesystem::path& folder) {
  for (const Piece& piece : pieces) {
    const int problem = take(folder / piece.name, piece.bytes);
    if (problem == 0) continue;
    free_ending_rooms(folder);
    return fail(ErrorCode::io, folder.string() + ": the disk space to complete the session cannot be reserved: " +
                                   std::generic_category().message(problem));
  }
  return {};
}

void free_ending_room(const std::filesystem::path& folder, EndingRoom room) {
  for (const Piece& piece : pieces) {
    if (piece.room == room) ::unlink((folder / piece.name).c_str());
  }
}

void free_ending_rooms(const std::filesystem::path& folder) {
  for (const Piece& piece : pieces) ::unlink((folder / piece.name).c_str());
}

}  // namespace todbench
