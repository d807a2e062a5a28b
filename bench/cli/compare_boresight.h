// SPDX-License-Identifier: GPL-3.0-or-later
// Option --boresight of `todbench compare`: change of the line of sight between two sessions.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "bench/cli/console.h"
#include "bench/session/open_session.h"

namespace todbench {

/// Session and its folder as stated on the command line. The references are valid during the call.
struct NamedSession {
  const std::string& folder;
  const Session& session;
};

/// Prints boresight() of both sessions and its assumptions. `accepted_files`: accepted changes. Returns the exit code.
[[nodiscard]] int show_boresight(Console& console, const std::array<NamedSession, 2>& sessions, const Opening& opening,
                                 const std::vector<std::string>& accepted_files);

}  // namespace todbench
