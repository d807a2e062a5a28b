// SPDX-License-Identifier: GPL-3.0-or-later
// Disk space reserved at the start of a session for its end, so that a run that fills the disk can still record it.
#pragma once

#include <filesystem>

#include "acquisition/base/result.h"

namespace todbench {

/// Files written at the end of a session, in this order. A file without its own reserve may use that of the previous
/// step but not that of the next, so the manifest can always be written.
enum class EndingRoom {
  results,   ///< curves and comparison
  state,     ///< log, provenance and verdict
  manifest,  ///< after the report, which has no reserve
};

/// Reserves the space with hidden files in the folder. Errors: `io` with the folder (no space, or a limit).
[[nodiscard]] Result<void> take_ending_rooms(const std::filesystem::path& folder);
/// Releases a reserve; no effect if it does not exist.
void free_ending_room(const std::filesystem::path& folder, EndingRoom room);
/// Releases all remaining reserves, for a session that failed to start or to finish.
void free_ending_rooms(const std::filesystem::path& folder);

}  // namespace todbench
