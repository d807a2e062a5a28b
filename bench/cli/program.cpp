// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/cli/program.h"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <exception>
#include <functional>
#include <limits>
#include <sstream>
#include <string_view>
#include <vector>

#include "acquisition/base/number_range.h"
#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/cli/exit_codes.h"
#include "bench/judgement/verdict.h"
#include "bench/session/build_info.h"
#include "bench/text/text.h"
#include "bench/text/unit_hint.h"

namespace todbench {

void finish_command(CLI::App& command, Program& program, std::function<int(Console&)> action) {
  command.add_flag("--json", program.common.console.json,
                   "writes one JSON object, and nothing else, to standard output");
  command.add_flag("--quiet,-q", program.common.console.quiet, "writes no progress and no notes to standard error");
  command.add_option("--seed", program.common.seed, "seed of all random numbers")
      ->check(whole_number(0, std::numeric_limits<std::int64_t>::max()))
      ->capture_default_str()
      ->each([&program](const std::string&) { program.common.seed_given = true; });
  command.callback([&program, action = std::move(action)] {
    program.chosen = [&program, action] {
      Console console(program.common.console);
      return action(console);
    };
  });
}

int report_error(Console& console, const Error& error) {
  console.error(error.message);
  return exit_code(error.code);
}

CLI::Validator number_in(double low, double high, std::string_view unit) {
  const NumberRange range = NumberRange::between(low, high);
  const std::string key = "in-" + std::string(unit);
  return CLI::Validator(
      [range, key](const std::string& text) {
        const auto value = parse_number(text);
        if (value && range.contains(*value)) return std::string();
        return "expected a number from " + number_text(range.low) + " to " + number_text(range.high) + ", found '" +
               one_line(text) + "'" + (value ? unit_hint(key, *value, range) : "");
      },
      "");
}

CLI::Validator whole_number(std::int64_t low, std::int64_t high) {
  const std::string expected = "a whole number from " + std::to_string(low) + " to " + std::to_string(high);
  return CLI::Validator(
      [=](const std::string& text) {
        std::int64_t value = 0;
        const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
        const bool whole = problem == std::errc() && end == text.data() + text.size();
        return whole && value >= low && value <= high ? std::string()
                                                      : "expected " + expected + ", found '" + one_line(text) + "'";
      },
      "");
}

namespace {

/// Returns an error sentence for a list with an empty item, for example "1,,2": the parser would ignore the item.
std::optional<std::string> list_with_a_hole(const CLI::App& app, const std::vector<std::string>& words) {
  const CLI::App* command = &app;
  const CLI::Option* list = nullptr;
  for (const std::string& word : words) {
    std::string value = word;
    if (word.starts_with("--")) {
      const std::size_t equals = word.find('=');
      list = command->get_option_no_throw(word.substr(0, equals));
      if (equals == std::string::npos) continue;
      value = word.substr(equals + 1);
    } else if (list == nullptr) {
      for (const CLI::App* below : command->get_subcommands({})) {
        if (below->get_name() == word) command = below;
      }
    }
    const bool hole = value.starts_with(',') || value.ends_with(',') || value.find(",,") != std::string::npos;
    if (list != nullptr && list->get_delimiter() == ',' && hole) {
      return command->get_name() + ": " + list->get_name() + ": expected values separated by single commas, found '" +
             one_line(value) + "'";
    }
    list = nullptr;
  }
  return std::nullopt;
}

/// Describes the error of a command line in one sentence that suggests the nearest valid word.
std::string usage_sentence(const CLI::App& app, const CLI::ParseError& error, const std::vector<std::string>& words) {
  std::vector<std::string> commands;
  for (const CLI::App* command : visible_commands(app)) commands.push_back(command->get_name());
  const std::string asked = words.empty() || words.front().starts_with('-') ? "" : words.front();
  const auto all = app.get_subcommands({});
  const bool known =
      std::any_of(all.begin(), all.end(), [&](const CLI::App* command) { return command->get_name() == asked; });
  if (words.empty()) {
    return "no command was given. Three commands to try:\n"
           "  todbench demo             runs the whole test on an emulated laboratory in about 40 s, without hardware\n"
           "  todbench devices          lists the connected cameras\n"
           "  todbench simulate demo    simulates the TOD curve of the sensor in the demonstration plan\n"
           "todbench --help lists the commands, todbench COMMAND --help lists the options of a command";
  }
  if (asked.empty()) return one_line(error.what()) + " (todbench --help lists the commands)";
  if (!known) {
    return "unknown command '" + one_line(asked) + "'" + nearest_name_hint(asked, commands) +
           " (todbench --help lists the commands)";
  }
  const CLI::App* command = app.get_subcommand(asked);
  if (words.size() > 1) {
    for (const CLI::App* below : command->get_subcommands({})) {
      if (below->get_name() == words[1]) command = below;
    }
  }
  std::vector<std::string> options;
  std::vector<const CLI::App*> parts{command};
  for (const CLI::App* part : command->get_subcommands([](const CLI::App*) { return true; })) parts.push_back(part);
  for (const CLI::App* part : parts) {
    for (const CLI::Option* option : part->get_options()) {
      for (const auto& name : option->get_lnames()) options.push_back("--" + name);
    }
  }
  for (const auto& word : words) {
    const std::string name = word.substr(0, word.find('='));
    if (!name.starts_with("--") || std::find(options.begin(), options.end(), name) != options.end()) continue;
    return asked + ": unknown option " + one_line(name) + nearest_name_hint(name, options);
  }
  if (dynamic_cast<const CLI::ValidationError*>(&error) != nullptr) return asked + ": " + one_line(error.what());
  return asked + ": " + one_line(error.what()) + " (todbench " + asked + " --help lists the options)";
}

/// Returns two lines of at most 110 characters.
std::string exit_code_footer() {
  std::string text = "Exit codes:";
  std::size_t line = text.size();
  for (const auto& [code, words] : exit_code_meanings) {
    const std::string last = code == exit_code_meanings.back().code ? "." : ";";
    std::istringstream said(std::to_string(code) + " " + std::string(words) + last);
    for (std::string word; said >> word; line += word.size() + 1) {
      const bool fits = line + 1 + word.size() <= 110;
      text += (fits ? " " : "\n") + word;
      if (!fits) line = 0;
    }
  }
  return text;
}

/// A disk limit or a closed pipe becomes an error of that write instead of ending a measurement.
void write_errors_instead_of_signals() {
  ::signal(SIGPIPE, SIG_IGN);
  ::signal(SIGXFSZ, SIG_IGN);
}

int run(int argc, char** argv, void (*add_commands)(CLI::App&, Program&)) {
  StopSignals stop;
  Program program;
  program.stop = &stop;
  CLI::App app("Measures the TOD of thermal cameras and of their simulated twins with a model observer.", "todbench");
  app.require_subcommand(1);
  app.footer(exit_code_footer());
  const BuildInfo info = build_info();
  app.set_version_flag("--version", "todbench " + std::string(info.version) + " (" + std::string(info.commit) + ")");
  add_commands(app, program);
  add_examples(app);
  // For tests of the examples: `todbench parse WORDS...` only parses them.
  const bool only_parsed = argc > 1 && std::string_view(argv[1]) == "parse";
  if (only_parsed) {
    --argc;
    ++argv;
  }
  if (argc > 1 && std::string_view(argv[1]) == "complete") {
    print_completions(app, {argv + 2, argv + argc});
    return 0;
  }
  if (const auto list = list_with_a_hole(app, {argv + 1, argv + argc})) {
    std::fprintf(stderr, "todbench: %s\n", list->c_str());
    return exit_code(ErrorCode::invalid_input);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    std::ostringstream said;
    const int code = app.exit(success, said, said);
    std::string text = std::move(said).str();
    if (text.ends_with('\n')) text.pop_back();
    std::fputs(broken_for(STDOUT_FILENO, text).c_str(), stdout);
    return code;
  } catch (const CLI::ParseError& error) {
    const std::vector<std::string> words(argv + 1, argv + argc);
    std::fputs(broken_for(STDERR_FILENO, "todbench: " + usage_sentence(app, error, words)).c_str(), stderr);
    return exit_code(ErrorCode::invalid_input);
  }
  if (only_parsed) return 0;
  const int code = program.chosen();
  if (auto written = finish_output(); !written) {
    std::fprintf(stderr, "todbench: %s\n", one_line(written.error().message).c_str());
    return exit_code(written.error().code);
  }
  return code;
}

}  // namespace

int run_program(int argc, char** argv, void (*add_commands)(CLI::App&, Program&)) {
  // Interfaces of this project do not throw; an exception of third-party code is reported as a defect.
  write_errors_instead_of_signals();
  try {
    return run(argc, argv, add_commands);
  } catch (const std::exception& exception) {
    std::fprintf(stderr, "todbench: internal error: %s\n", one_line(exception.what()).c_str());
    return 7;
  }
}

int run_demonstration(int argc, char** argv) {
  return run_program(argc, argv, add_demo_command);
}

}  // namespace todbench
