// Room on the disk for the end of a session, taken at its start: a run that fills the disk can still say so.
#pragma once

#include <filesystem>

#include "acquisition/core/result.h"

namespace todbench {

/// What a session writes when it ends, in this order. What has no room of its own may take that of the one before, but
/// not that of the next: whatever is large leaves the manifest possible.
enum class EndingRoom {
  results,   ///< curves and comparison
  state,     ///< log, provenance and verdict
  manifest,  ///< after a report, which has no room of its own
};

/// Takes the room: hidden files in the folder. `io` with the folder where a file system or a limit has none.
[[nodiscard]] Result<void> take_ending_rooms(const std::filesystem::path& folder);
/// Gives a room back; nothing where it was not taken.
void free_ending_room(const std::filesystem::path& folder, EndingRoom room);
/// All that are left, for a session that did not begin or did not end.
void free_ending_rooms(const std::filesystem::path& folder);

}  // namespace todbench
