// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/cli/key_options.h"

#include <utility>

#include "acquisition/base/try.h"
#include "bench/cli/commands.h"
#include "bench/text/text.h"
#include "bench/text/unit_hint.h"

namespace todbench {
namespace {

/// Validates a text by its type alone, because the parser has no plan yet.
CLI::Validator check_of(const KeyType& type, const std::string& option) {
  return {[type, option](const std::string& text) {
            const auto value = value_from_text(type, text);
            if (value) return std::string();
            const auto number = parse_number(text);
            const auto* key = std::get_if<NumberKey>(&type);
            return value.error().message + (number && key ? unit_hint(option, *number, key->range) : "");
          },
          ""};
}

/// Returns the validator of one word; for a list, of one element.
std::optional<CLI::Validator> word_check(const KeyType& type, const std::string& option) {
  if (const auto* numbers = std::get_if<NumbersKey>(&type)) return check_of(NumberKey{numbers->range}, option);
  if (std::holds_alternative<NumberKey>(type) || std::holds_alternative<WholeKey>(type)) return check_of(type, option);
  return std::nullopt;
}

bool is_list(const KeyType& type) {
  return std::holds_alternative<NumbersKey>(type) || std::holds_alternative<ChoicesKey>(type) ||
         std::holds_alternative<ResourcesKey>(type);
}

/// Help texts begin with a small letter, except abbreviations such as "TOML".
std::string with_small_start(std::string_view sentence) {
  std::string text(sentence);
  const auto is_capital = [&](std::size_t i) { return i < text.size() && text[i] >= 'A' && text[i] <= 'Z'; };
  if (is_capital(0) && !is_capital(1)) text[0] = static_cast<char>(text[0] - 'A' + 'a');
  return text;
}

std::string description_of(const PlanKey& key) {
  const std::string unit = key.unit.empty() || key.unit == "%" ? "" : " (" + std::string(key.unit) + ")";
  return with_small_start(key.sentence) + unit + (is_list(key.type) ? ", separated by commas" : "") +
         (std::holds_alternative<ChoiceKey>(key.type) ? ": " + expected_of(key.type) : "");
}

void add_key_option(CLI::App& command, const KeyAt& at, KeyOverrides& overrides) {
  const std::string path = path_of(*at.section, *at.key), name(at.key->option.name);
  const auto keep = [&overrides, path](const std::vector<std::string>& words) {
    overrides.given[path] = words;
    return true;
  };
  if (std::holds_alternative<FlagKey>(at.key->type)) {
    command.add_flag_callback(
        name, [&overrides, path] { overrides.given[path] = {"yes"}; }, description_of(*at.key));
    return;
  }
  CLI::Option* option = command.add_option(name, keep, description_of(*at.key));
  option->type_name("TEXT")->type_size(1);
  if (is_list(at.key->type)) {
    option->expected(1, CLI::detail::expected_max_vector_size)->delimiter(',')->allow_extra_args(false);
    option->take_all();
  }
  if (const auto check = word_check(at.key->type, name)) option->check(*check);
}

}  // namespace

bool KeyOverrides::has(std::string_view path) const {
  return given.find(path) != given.end();
}

void add_key_options(CLI::App& command, OptionOf of, KeyOverrides& overrides, std::string_view without) {
  for (const PlanSection& section : plan_sections()) {
    for (const PlanKey& key : section.keys) {
      if (key.option.name.empty() || key.option.of != of || path_of(section, key) == without) continue;
      add_key_option(command, {&section, &key, 0}, overrides);
    }
  }
}

Result<KeyValue> given_value(const KeyOverrides& overrides, std::string_view path) {
  const PlanKey& key = *plan_key(path).key;
  std::string text;
  for (const std::string& word : overrides.given.find(path)->second) text += (text.empty() ? "" : ",") + word;
  Result<KeyValue> value = value_from_text(key.type, text);
  if (!value) return fail_at(value.error().code, std::string(key.option.name), value.error().message);
  return value;
}

Result<void> apply(const KeyOverrides& overrides, Plan& plan) {
  for (const auto& [path, words] : overrides.given) {
    TODBENCH_TRY(const auto value, given_value(overrides, path));
    plan_key(path).key->place.set(plan, 0, value);
  }
  plan = with_absolute_references(std::move(plan), "");
  return {};
}

Error in_terms_of_options(const Error& error) {
  if (!error.key) return with_context("with these options", error);
  for (const PlanSection& section : plan_sections()) {
    for (const PlanKey& key : section.keys) {
      if (key.option.name.empty() || error.key->name != path_of(section, key)) continue;
      return renamed(error, std::string(key.option.name));
    }
  }
  return with_context("with these options", renamed(error, error.key->name));
}

}  // namespace todbench
