// SPDX-License-Identifier: GPL-3.0-or-later
// Session folder on the command line.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <utility>
#include <vector>

#include "bench/cli/console.h"
#include "bench/session/open_session.h"

namespace todbench {

/// Adds --accept-changed. `accepted` must outlive the parser.
void add_accept_changed(CLI::App& command, bool& accepted);

/// Calls open_session(), and reports accepted changes on standard error, even with --quiet.
[[nodiscard]] Result<Session> opened(Console& console, const std::string& folder, const Opening& opening);
/// Returns "s: changed, removed or added after the session ended: fits.json"; empty if no change was accepted.
[[nodiscard]] std::string accepted_sentence(const std::string& folder, const Session& session);
/// Adds "accepted_changes" to the JSON output of a command, if changes may be accepted.
void add_accepted_changes(Json& json, const Opening& opening, const std::vector<std::string>& files);

}  // namespace todbench
