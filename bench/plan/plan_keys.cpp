// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/plan_keys.h"

#include <cassert>

#include "bench/text/text.h"

namespace todbench {

std::string path_of(const PlanSection& section, const PlanKey& key) {
  return (section.name.empty() ? "" : std::string(section.name) + ".") + std::string(key.name);
}

KeyAt plan_key(std::string_view path) {
  for (const PlanSection& section : plan_sections()) {
    for (const PlanKey& key : section.keys) {
      if (path_of(section, key) == path) return {&section, &key, 0};
    }
  }
  assert(false && "no such key");
  return {};
}

KeyValue default_of(const KeyAt& key) {
  Plan plan;
  if (key.section->repeated()) key.section->rows.resize(plan, 1);
  return key.key->place.get(plan, 0);
}

KeyType type_in(const PlanKey& key, const Plan& plan) {
  if (key.narrowed) {
    if (const std::optional<NumberRange> range = key.narrowed(plan)) return NumberKey{*range};
  }
  return key.type;
}

std::string_view name_in(const TomlReader& table, const PlanKey& key) {
  for (const std::string_view other : key.other_names) {
    if (!table.has(key.name) && table.has(other)) return other;
  }
  return key.name;
}

std::vector<TomlReader> rows_in(TomlReader& parent, const PlanSection& section) {
  const std::size_t dot = section.name.rfind('.');
  const std::string_view own = dot == std::string_view::npos ? section.name : section.name.substr(dot + 1);
  for (const std::string_view other : section.other_names) {
    if (!parent.has(own) && parent.has(other)) return parent.sections(other);
  }
  return parent.sections(own);
}

std::vector<PlanMistake> mistakes_in(const Plan& plan) {
  std::vector<PlanMistake> all;
  for (const PlanSection& section : plan_sections()) {
    for (std::size_t row = 0; row < section.count(plan); ++row) {
      for (const PlanKey& key : section.keys) {
        const auto add = [&](std::vector<ValueMistake> found) {
          for (ValueMistake& mistake : found) all.push_back({{&section, &key, row}, std::move(mistake)});
        };
        add(mistakes_of(type_in(key, plan), key.place.get(plan, row)));
        if (key.check) add(key.check(plan, row));
      }
    }
  }
  return all;
}

Error error_of(const PlanMistake& mistake) {
  const std::string section(mistake.at.section->name);
  const std::string in = section.empty() ? "" : " in [" + section + "]";
  return {ErrorCode::invalid_input,
          "key '" + std::string(mistake.at.key->name) + "'" + in + ": " + mistake.mistake.sentence,
          ErrorKey{path_of(*mistake.at.section, *mistake.at.key), mistake.mistake.sentence}};
}

Result<void> validate(const Plan& plan) {
  const std::vector<PlanMistake> mistakes = mistakes_in(plan);
  if (!mistakes.empty()) return tl::unexpected(error_of(mistakes.front()));
  return {};
}

}  // namespace todbench
