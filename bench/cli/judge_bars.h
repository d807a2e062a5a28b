// SPDX-License-Identifier: GPL-3.0-or-later
// todbench judge --bars and --answers: a person judges the bars that a session kept.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "bench/cli/console.h"
#include "bench/enhance/bars_questions.h"
#include "bench/session/open_session.h"

namespace todbench {

struct BarsArguments {
  std::string session, out, answers;
  bool questions = false;
  BarsRequest request{};
  PersonFacts person{};
  Opening opening{};
};

/// Adds --bars, --answers and the options of both. `arguments` outlives the parser.
void add_bars_options(CLI::App& command, BarsArguments& arguments);
/// Writes the pictures, or adds the answers to the session and writes its report again. Returns the exit code.
[[nodiscard]] int run_judge_bars(Console& console, const BarsArguments& arguments);

}  // namespace todbench
