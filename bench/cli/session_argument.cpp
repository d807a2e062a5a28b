// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/cli/session_argument.h"

#include <fmt/format.h>

namespace todbench {

void add_accept_changed(CLI::App& command, bool& accepted) {
  command.add_flag("--accept-changed", accepted,
                   "reads a session whose files are not those that the run wrote, and lists these files");
}

Result<Session> opened(Console& console, const std::string& folder, const Opening& opening) {
  auto session = open_session(folder, opening);
  if (!session) return session;
  if (const std::string sentence = accepted_sentence(folder, *session); !sentence.empty()) console.warning(sentence);
  if (session->cut_off)
    console.warning(folder + ": the run was cut off, so the files of the session cannot be verified");
  return session;
}

std::string accepted_sentence(const std::string& folder, const Session& session) {
  if (session.accepted_changes.empty()) return "";
  return fmt::format("{}: changed, removed or added after the session ended (accepted): {}", folder,
                     fmt::join(session.accepted_changes, ", "));
}

void add_accepted_changes(Json& json, const Opening& opening, const std::vector<std::string>& files) {
  if (opening.accept_changed) json["accepted_changes"] = files;
}

}  // namespace todbench
