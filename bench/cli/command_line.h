// The command line as data: what its manual says and what a shell may complete.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "bench/cli/commands.h"
#include "bench/text/manual_page.h"

namespace todbench {

/// The commands that help lists, as they were added; what only a build or a shell calls is in no group.
[[nodiscard]] std::vector<const CLI::App*> visible_commands(const CLI::App& app);

/// A page of the whole, then one for each visible command.
[[nodiscard]] std::vector<ManualPage> manual_pages(const CLI::App& app, const std::string& version,
                                                   const std::string& date);

/// What may stand in place of a word.
struct Completion {
  std::vector<std::string> words;  ///< sorted as a person should see them; not narrowed to what was typed
  bool files = false;              ///< and any file or folder
};

/// What may stand in place of the last of `words`, which begin after the name of the program. `cameras` is asked only
/// where a camera is wanted: it looks at every interface.
[[nodiscard]] Completion completion(const CLI::App& app, const std::vector<std::string>& words,
                                    const std::function<std::vector<std::string>()>& cameras);

/// `todbench complete WORDS...`, which the shell calls: a line for each word that may stand in place of the last one,
/// ":files" behind them where any file may. Not a command of the parser, because the words are whatever was typed.
void print_completions(const CLI::App& app, const std::vector<std::string>& words);

/// `todbench manual`, which help does not list; `app` outlives the run.
void add_manual_command(CLI::App& app, Program& program);

}  // namespace todbench
