// SPDX-License-Identifier: GPL-3.0-or-later
// The command line as data: for the manual and for completion in a shell.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/cli/commands.h"
#include "bench/text/manual_page.h"

namespace todbench {

/// Returns the commands that the help lists, in the order in which they were added. The help does not list commands for
/// builds and shells, which have no group.
[[nodiscard]] std::vector<const CLI::App*> visible_commands(const CLI::App& app);

/// A valid command line with its effect.
struct CommandExample {
  std::string line, effect;
};
/// Returns the examples of a command. `command`: for example "fit" or "history add".
[[nodiscard]] std::vector<CommandExample> examples_of(std::string_view command);
/// Adds the examples to the help of every command.
void add_examples(CLI::App& app);

/// Returns a page for the program, then one page for each visible command. `date`: date of the release, "2026-11-22".
[[nodiscard]] std::vector<ManualPage> manual_pages(const CLI::App& app, const std::string& version,
                                                   const std::string& date);

/// Candidates for the completion of a word.
struct Completion {
  std::vector<std::string> words;  ///< in the order of display; includes words that do not begin with the typed letters
  bool files = false;              ///< also any file or folder
};

/// Returns the candidates for the last of `words`, which start after the name of the program. `cameras` is called only
/// if a camera is expected, because the call searches every interface.
[[nodiscard]] Completion completion(const CLI::App& app, const std::vector<std::string>& words,
                                    const std::function<std::vector<std::string>()>& cameras);

/// Implements `todbench complete WORDS...`, which the shell calls. Prints one line for each candidate for the last
/// word, then ":files" if any file may follow. This is not a command of the parser, because its arguments are arbitrary
/// words.
void print_completions(const CLI::App& app, const std::vector<std::string>& words);

/// Adds `todbench manual`, which the help does not list. `app` must outlive the run.
void add_manual_command(CLI::App& app, Program& program);

}  // namespace todbench
