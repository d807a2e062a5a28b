// SPDX-License-Identifier: GPL-3.0-or-later
// Common part of the command-line programs.
#pragma once

// Forward declaration, because the header of the parser is slow to compile.
namespace CLI {
class App;
}

namespace todbench {

struct Program;

/// Parses the command line with the commands of `add_commands`, runs the chosen command and returns the exit code of
/// the process. Prints errors in one line on standard error.
[[nodiscard]] int run_program(int argc, char** argv, void (*add_commands)(CLI::App&, Program&));

/// Runs the program with the demonstration as the only command.
[[nodiscard]] int run_demonstration(int argc, char** argv);

}  // namespace todbench
