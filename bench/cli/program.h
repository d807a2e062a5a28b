// What the programs of the command line have in common.
#pragma once

// Without the parser, which costs more to compile than a program that only calls these.
namespace CLI {
class App;
}

namespace todbench {

struct Program;

/// Reads the words of the command line, runs the command that they name of those that `add_commands` adds, and returns
/// the exit code of the process. What is wrong is said in one line on standard error.
[[nodiscard]] int run_program(int argc, char** argv, void (*add_commands)(CLI::App&, Program&));

/// The same with the demonstration as the only command.
[[nodiscard]] int run_demonstration(int argc, char** argv);

}  // namespace todbench
