// The one way to a session that was written before: nothing of it is believed that its manifest does not vouch for.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "bench/session/manifest.h"
#include "bench/session/session_folder.h"

namespace todbench {

enum class SessionCondition {
  intact,   ///< every file is what the run wrote, and there is no other
  changed,  ///< files were changed, removed or added after the session ended
  cut_off,  ///< no manifest, and provenance.json says that the run goes on: it does, or it was cut off
};
[[nodiscard]] std::string_view to_string(SessionCondition condition);

struct SessionCheck {
  SessionCondition condition = SessionCondition::intact;
  ManifestCheck files;
  /// What a reader would believe and the manifest does not vouch for, sorted: files changed, missing or added. Neither
  /// a report page that is missing nor a foreign file that nobody reads.
  std::vector<std::string> not_vouched_for;
  std::string sentence;  ///< what `not_vouched_for` or `cut_off` means; empty where there is neither
};
/// Reads every file. `invalid_input`: not a session folder. `io` with the path.
[[nodiscard]] Result<SessionCheck> check_session(const std::filesystem::path& folder);

/// What a reader of a session takes. Whoever shows anything of a session shows its `accepted_changes` and `cut_off`.
struct Opening {
  bool accept_changed = false;  ///< also sessions whose files are not those that the run wrote
  bool accept_cut_off = false;  ///< also runs that were cut off, which have no manifest
};

/// read_session() after check_session(). `invalid_input`: as these, and a session that `opening` does not take, with
/// the sentence that says why.
[[nodiscard]] Result<Session> open_session(const std::filesystem::path& folder, const Opening& opening);
/// Success when open_session() would take the folder as intact: before something is written into it.
[[nodiscard]] Result<void> require_intact(const std::filesystem::path& folder);

}  // namespace todbench
