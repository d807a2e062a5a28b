// SPDX-License-Identifier: GPL-3.0-or-later
// Options --bars and --answers of `todbench judge`: a person judges the pictures of bars stored in a session.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "bench/cli/console.h"
#include "bench/enhance/bars_questions.h"
#include "bench/session/open_session.h"

namespace todbench {

/// Arguments of --bars and --answers.
struct BarsArguments {
  std::string session,  ///< folder of the session
      out,              ///< new folder for the pictures
      answers;          ///< folder of --bars with the answers of a person; empty: no answers are read
  /// Writes pictures of bars and spots for a person.
  bool questions = false;
  /// Selection of decisions.
  BarsRequest request{};
  /// Facts of the person who answered.
  PersonFacts person{};
  /// States of the session files that are accepted.
  Opening opening{};
};

/// Adds --bars, --answers and their further options. `arguments` must outlive the parser.
void add_bars_options(CLI::App& command, BarsArguments& arguments);
/// Writes the pictures, or adds the answers to the session and rewrites its report. Returns the exit code.
[[nodiscard]] int run_judge_bars(Console& console, const BarsArguments& arguments);

}  // namespace todbench
