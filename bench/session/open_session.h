// SPDX-License-Identifier: GPL-3.0-or-later
// Opens an existing session and rejects content that its manifest does not confirm. All readers of sessions use these
// functions.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "bench/session/manifest.h"
#include "bench/session/session_folder.h"

namespace todbench {

/// State of the files of a session.
enum class SessionCondition {
  intact,   ///< all files are as the run wrote them, and no other files exist
  changed,  ///< files were changed, removed or added after the end of the session
  cut_off,  ///< no manifest and state running: the run is in progress or was cut off
};
/// Returns the name of the enumerator.
[[nodiscard]] std::string_view to_string(SessionCondition condition);

/// Result of a check of a session against its manifest.
struct SessionCheck {
  SessionCondition condition = SessionCondition::intact;
  ManifestCheck files;
  /// Files that a reader would use but the manifest does not confirm, sorted: changed, missing, added or linked.
  /// Missing report pages and foreign files that no reader uses are not included.
  std::vector<std::string> not_vouched_for;
  std::string sentence;  ///< explains `not_vouched_for` or `cut_off`; empty if neither applies
};
/// Reads every file. Errors: `invalid_input` (not a session folder), `io` with the path.
[[nodiscard]] Result<SessionCheck> check_session(const std::filesystem::path& folder);

/// Sessions that a reader accepts. Code that presents a session must show its `accepted_changes` and `cut_off`.
struct Opening {
  bool accept_changed = false;  ///< accepts sessions with files that the run did not write in this form
  bool may_accept = true;       ///< whether the user may accept changes: the error then names the option
  bool accept_cut_off = false;  ///< accepts runs that were cut off, which have no manifest
};

/// Checks a session with check_session() and reads it with read_session(). Errors: those of both functions, and
/// `invalid_input` with the reason for a session that `opening` does not accept.
[[nodiscard]] Result<Session> open_session(const std::filesystem::path& folder, const Opening& opening);
/// Succeeds if open_session() would accept the folder as intact. Call it before writing to a session.
[[nodiscard]] Result<void> require_intact(const std::filesystem::path& folder);

}  // namespace todbench
