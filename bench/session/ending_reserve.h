// SPDX-License-Identifier: GPL-3.0-or-later
// Disk space reserved at the start of a session for the files of its end. A run that fills the disk can still write
// these files.
#pragma once

#include <filesystem>

#include "acquisition/base/result.h"

namespace todbench {

/// Groups of files written at the end of a session, in this order. Each group has a reserve. The program releases this
/// reserve before it writes the group. A file can use the space that earlier groups left over, but not the reserves of
/// later groups. The manifest can therefore always be written.
enum class EndingRoom {
  results,   ///< curves and comparison
  state,     ///< log, provenance and verdict
  manifest,  ///< written after the report, which has no reserve
};

/// Reserves the space as hidden files in the folder. Errors: `io` with the folder (no space, or a limit).
[[nodiscard]] Result<void> take_ending_rooms(const std::filesystem::path& folder);
/// Releases a reserve; no effect if it does not exist.
void free_ending_room(const std::filesystem::path& folder, EndingRoom room);
/// Releases all remaining reserves, for a session that failed to start or to finish.
void free_ending_rooms(const std::filesystem::path& folder);

}  // namespace todbench
