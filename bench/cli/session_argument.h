// A session folder on the command line.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <utility>
#include <vector>

#include "bench/cli/console.h"
#include "bench/session/open_session.h"

namespace todbench {

/// Adds --accept-changed. `accepted` outlives the parser.
void add_accept_changed(CLI::App& command, bool& accepted);

/// open_session(); what was accepted is said on standard error, whatever --quiet says.
[[nodiscard]] Result<Session> opened(Console& console, const std::string& folder, const Opening& opening);
/// "s: changed, removed or added after the session ended: fits.json"; empty when nothing was.
[[nodiscard]] std::string accepted_sentence(const std::string& folder, const Session& session);
/// Adds "accepted_changes" to what a command says in JSON, where changes were to be accepted.
void add_accepted_changes(Json& json, const Opening& opening, const std::vector<std::string>& files);

}  // namespace todbench
