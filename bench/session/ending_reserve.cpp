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
// A manifest has some 200 bytes for each of some twenty files; provenance and verdict have 8 KiB together and are
// written beside their earlier versions. Results may be larger than their room, a report always is: what does not fit
// is left out. In pieces, because a limit of the file size may be smaller than the whole.
constexpr std::array pieces{Piece{EndingRoom::manifest, ".room-for-manifest", 8 * 1024},
                            Piece{EndingRoom::state, ".room-for-state", 16 * 1024},
                            Piece{EndingRoom::results, ".room-for-results-1", 16 * 1024},
                            Piece{EndingRoom::results, ".room-for-results-2", 16 * 1024}};

/// 0 or the error number.
int take(const std::filesystem::path& file, off_t bytes) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
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
    return fail(ErrorCode::io,
                folder.string() + ": no room for the end of a session: " + std::generic_category().message(problem));
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
