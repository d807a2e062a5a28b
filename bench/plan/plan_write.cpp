// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <string>

#include "bench/plan/plan.h"
#include "bench/plan/plan_keys.h"

namespace todbench {

namespace {

void write_keys(std::string& text, const PlanSection& section, const Plan& plan, std::size_t row) {
  for (const PlanKey& key : section.keys) {
    if (key.replaced.in(plan)) continue;
    if (!key.written_at_default && key.place.get(plan, row) == default_of({&section, &key, row})) continue;
    const std::optional<std::string> value = toml_value(key.type, key.place.get(plan, row));
    if (value) text += std::string(key.name) + " = " + *value + "\n";
  }
}

/// Returns whether the section is omitted from a plan of defaults.
bool only_where_set(const PlanSection& section) {
  return std::none_of(section.keys.begin(), section.keys.end(),
                      [](const PlanKey& key) { return key.written_at_default; });
}

/// Free tables follow the other keys of their section, because keys after them would belong to them; those of a row
/// follow the row.
void write_free_tables(std::string& text, const PlanSection& section, const Plan& plan, std::size_t row) {
  for (const PlanKey& key : section.keys) {
    if (!std::holds_alternative<FreeTableKey>(key.type)) continue;
    const KeyValue value = key.place.get(plan, row);
    const auto& table = std::get<std::map<std::string, std::string>>(value);
    if (table.empty()) continue;
    text += "\n[" + path_of(section, key) + "]\n";
    for (const auto& [name, setting] : table) text += toml_string(name) + " = " + toml_string(setting) + "\n";
  }
}

}  // namespace

std::string to_toml(const Plan& plan) {
  std::string text;
  for (const PlanSection& section : plan_sections()) {
    const std::string header =
        section.repeated() ? "[[" + std::string(section.name) + "]]" : "[" + std::string(section.name) + "]";
    for (std::size_t row = 0; row < section.count(plan); ++row) {
      std::string keys;
      write_keys(keys, section, plan, row);
      if (keys.empty() && only_where_set(section)) continue;
      if (!section.name.empty()) text += "\n" + header + "\n";
      text += keys;
      write_free_tables(text, section, plan, row);
    }
  }
  return text;
}

}  // namespace todbench
