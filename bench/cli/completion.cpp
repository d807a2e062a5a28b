// SPDX-License-Identifier: GPL-3.0-or-later
// Candidates for completion in a shell: from the commands, the table of keys and the shipped descriptions.
#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "bench/cli/command_line.h"
#include "bench/plan/plan_keys.h"
#include "bench/plan/resources.h"

namespace todbench {
namespace {

/// Options and arguments that name a description, in any command.
struct NamedResource {
  std::string_view name;
  ResourceKind kind;
};
constexpr std::array named_resources{
    NamedResource{"--sensor", ResourceKind::sensor},  NamedResource{"--observer", ResourceKind::observer},
    NamedResource{"--plates", ResourceKind::plate},   NamedResource{"PLAN.toml", ResourceKind::plan},
    NamedResource{"SCENE.toml", ResourceKind::scene}, NamedResource{"SET.toml", ResourceKind::target_set},
};
constexpr std::string_view camera_argument = "CAMERA";

std::string name_of(const CLI::Option& option) {
  if (option.get_positional()) return option.get_name(true);
  return option.get_lnames().empty() ? "" : "--" + option.get_lnames().front();
}

bool takes_value(const CLI::Option& option) {
  return option.get_items_expected_max() > 0;
}

/// Returns the choices of an option: the parser stores them in the name of the type, "TEXT:{a,b}".
std::vector<std::string> choices_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const auto begin = type.find(":{");
  if (begin == std::string::npos || !type.ends_with('}')) return {};
  return CLI::detail::split(type.substr(begin + 2, type.size() - begin - 3), ',');
}

/// Returns the choices of the key that an option replaces.
std::vector<std::string> key_choices(std::string_view option) {
  for (const PlanSection& section : plan_sections()) {
    for (const PlanKey& key : section.keys) {
      if (key.option.name.empty() || key.option.name != option) continue;
      if (const auto* one = std::get_if<ChoiceKey>(&key.type)) return one->words;
      if (const auto* some = std::get_if<ChoicesKey>(&key.type)) return some->words;
    }
  }
  return {};
}

Completion values_of(const CLI::Option& option, const std::function<std::vector<std::string>()>& cameras) {
  const std::string name = name_of(option);
  for (const auto& resource : named_resources) {
    if (resource.name == name) return {resource_names(resource.kind), true};
  }
  if (name == camera_argument) return {cameras(), false};
  if (auto choices = choices_of(option); !choices.empty()) return {std::move(choices), false};
  if (auto choices = key_choices(name); !choices.empty()) return {std::move(choices), false};
  const std::string type = option.get_type_name();
  return {{}, type.starts_with("TEXT")};
}

const CLI::Option* option_named(const CLI::App& command, const std::string& word) {
  for (const CLI::Option* option : command.get_options()) {
    if (word.starts_with('-') && option->check_name(word)) return option;
  }
  return nullptr;
}

std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_group().empty() && !option->get_positional()) names.push_back(name_of(*option));
  }
  return names;
}

/// Returns the argument at the last word: counts the words before it that are neither options nor their values.
const CLI::Option* argument_at_end(const CLI::App& command, const std::vector<std::string>& words) {
  std::size_t place = 0;
  for (std::size_t i = 1; i + 1 < words.size(); ++i) {
    const CLI::Option* option = option_named(command, words[i]);
    if (option != nullptr && takes_value(*option)) {
      ++i;
    } else if (!words[i].starts_with('-')) {
      ++place;
    }
  }
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_positional() && place-- == 0) return option;
  }
  return nullptr;
}

}  // namespace

Completion completion(const CLI::App& app, const std::vector<std::string>& words,
                      const std::function<std::vector<std::string>()>& cameras) {
  if (words.size() < 2) {
    std::vector<std::string> names;
    for (const CLI::App* command : visible_commands(app)) names.push_back(command->get_name());
    if (!words.empty() && words.back().starts_with('-')) names = option_names(app);
    return {std::move(names), false};
  }
  const auto commands = visible_commands(app);
  const auto found = std::find_if(commands.begin(), commands.end(),
                                  [&](const CLI::App* command) { return command->get_name() == words.front(); });
  if (found == commands.end()) return {};
  const CLI::App& command = **found;
  if (words.size() > 2) {
    const CLI::Option* before = option_named(command, words[words.size() - 2]);
    if (before != nullptr && takes_value(*before)) return values_of(*before, cameras);
  }
  if (words.back().starts_with('-')) return {option_names(command), false};
  const CLI::Option* argument = argument_at_end(command, words);
  return argument == nullptr ? Completion{} : values_of(*argument, cameras);
}

}  // namespace todbench
