// SPDX-License-Identifier: GPL-3.0-or-later
// Builds the manual from the descriptions of the commands.
#include <fmt/format.h>

#include "bench/cli/command_line.h"
#include "bench/cli/exit_codes.h"
#include "bench/plan/resources.h"

namespace todbench {
namespace {

/// "-q, --quiet", "--lapse TEXT", "PLAN.toml".
std::string term_of(const CLI::Option& option) {
  if (option.get_positional()) return option.get_name(true);
  std::string term;
  for (const auto& name : option.get_snames()) term += (term.empty() ? "-" : ", -") + name;
  for (const auto& name : option.get_lnames()) term += (term.empty() ? "--" : ", --") + name;
  const std::string type = option.get_type_name();
  return option.get_items_expected_max() == 0 || type.empty() ? term : term + " " + type.substr(0, type.find(':'));
}

std::string meaning_of(const CLI::Option& option) {
  std::string meaning = option.get_description();
  const std::string type = option.get_type_name();
  if (const auto choices = type.find(":{"); choices != std::string::npos) meaning += "; " + type.substr(choices + 1);
  if (option.get_required() && !option.get_positional()) meaning += "; required";
  if (!option.get_default_str().empty()) meaning += "; default: " + option.get_default_str();
  return meaning;
}

std::vector<ManualTerm> terms_of(const CLI::App& command, bool positional) {
  std::vector<ManualTerm> terms;
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_group().empty() && option->get_positional() == positional)
      terms.push_back({term_of(*option), meaning_of(*option)});
  }
  return terms;
}

ManualSection exit_status() {
  ManualSection section{.title = "Exit status", .text = "", .terms = {}};
  for (const auto& [code, words] : exit_code_meanings)
    section.terms.push_back({std::to_string(code), std::string(words)});
  return section;
}

std::string listed(ResourceKind kind) {
  return fmt::format("{}", fmt::join(resource_names(kind), ", "));
}

std::string page_name(const CLI::App& app, const CLI::App& command) {
  return app.get_name() + "-" + command.get_name();
}

/// Usage of a command: "todbench sweep run [OPTIONS] SWEEP.toml".
std::string usage_of(const std::string& called, const CLI::App& command) {
  std::string usage = called + " " + command.get_name();
  usage += visible_commands(command).empty() ? " [OPTIONS]" : " COMMAND [OPTIONS]";
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_positional()) continue;
    const std::string name = option->get_name(true);
    usage += option->get_required() ? " " + name : " [" + name + "]";
  }
  return usage;
}

void add_arguments(ManualPage& page, const CLI::App& command, const std::string& of) {
  if (auto terms = terms_of(command, true); !terms.empty())
    page.sections.push_back({.title = "Arguments" + of, .text = "", .terms = std::move(terms)});
  page.sections.push_back({.title = "Options" + of, .text = "", .terms = terms_of(command, false)});
}

void add_example_section(ManualPage& page, const std::string& command) {
  ManualSection section{.title = "Examples of " + command, .text = "", .terms = {}};
  for (const CommandExample& example : examples_of(command)) section.terms.push_back({example.line, example.effect});
  if (!section.terms.empty()) page.sections.push_back(std::move(section));
}

ManualPage command_page(const CLI::App& app, const CLI::App& command) {
  ManualPage page{.name = page_name(app, command),
                  .sentence = command.get_description(),
                  .date = "",
                  .version = "",
                  .synopsis = {},
                  .sections = {},
                  .see_also = {app.get_name()}};
  page.synopsis = {usage_of(app.get_name(), command)};
  add_arguments(page, command, "");
  add_example_section(page, command.get_name());
  for (const CLI::App* below : visible_commands(command)) {
    const std::string called = app.get_name() + " " + command.get_name();
    page.synopsis.push_back(usage_of(called, *below));
    const std::string name = command.get_name() + " " + below->get_name();
    page.sections.push_back({.title = name, .text = below->get_description() + ".", .terms = {}});
    add_arguments(page, *below, " of " + name);
    add_example_section(page, name);
  }
  page.sections.push_back(exit_status());
  return page;
}

ManualPage main_page(const CLI::App& app) {
  std::string sentence = app.get_description();
  if (sentence.ends_with('.')) sentence.pop_back();
  ManualPage page{.name = app.get_name(),
                  .sentence = sentence,
                  .date = "",
                  .version = "",
                  .synopsis = {app.get_name() + " [OPTIONS] COMMAND [ARGUMENTS]"},
                  .sections = {},
                  .see_also = {}};
  for (const CLI::App* command : visible_commands(app)) {
    const std::string title = "Commands: " + command->get_group();
    if (page.sections.empty() || page.sections.back().title != title)
      page.sections.push_back({.title = title, .text = "", .terms = {}});
    page.sections.back().terms.push_back({command->get_name(), command->get_description()});
    page.see_also.push_back(page_name(app, *command));
  }
  page.sections.push_back({.title = "Options", .text = "", .terms = terms_of(app, false)});
  page.sections.push_back({.title = "Shipped descriptions",
                           .text = "These descriptions are known by name. "
                                   "A reference that contains a slash or ends with .toml is a file.",
                           .terms = {{"plans", listed(ResourceKind::plan)},
                                     {"plates", listed(ResourceKind::plate)},
                                     {"sensors", listed(ResourceKind::sensor)},
                                     {"observers", listed(ResourceKind::observer)},
                                     {"scenes", listed(ResourceKind::scene)},
                                     {"targets", listed(ResourceKind::target)},
                                     {"sets of targets", listed(ResourceKind::target_set)}}});
  page.sections.push_back(exit_status());
  page.sections.push_back(
      {.title = "Environment", .text = "", .terms = {{"NO_COLOR", "if set, no colors on a terminal"}}});
  return page;
}

}  // namespace

std::vector<const CLI::App*> visible_commands(const CLI::App& app) {
  std::vector<const CLI::App*> commands;
  for (const CLI::App* command : app.get_subcommands({})) {
    if (!command->get_group().empty()) commands.push_back(command);
  }
  return commands;
}

std::vector<ManualPage> manual_pages(const CLI::App& app, const std::string& version, const std::string& date) {
  std::vector<ManualPage> pages{main_page(app)};
  for (const CLI::App* command : visible_commands(app)) pages.push_back(command_page(app, *command));
  for (ManualPage& page : pages) {
    page.version = version;
    page.date = date;
  }
  return pages;
}

}  // namespace todbench
