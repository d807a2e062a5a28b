#include <string>

#include "bench/plan/plan.h"
#include "bench/plan/plan_keys.h"

namespace todbench {

namespace {

void write_keys(std::string& text, const PlanSection& section, const Plan& plan, std::size_t row) {
  for (const PlanKey& key : section.keys) {
    const std::optional<std::string> value = toml_value(key.type, key.place.get(plan, row));
    if (value) text += std::string(key.name) + " = " + *value + "\n";
  }
}

/// Free tables stand behind the keys of their section, which would otherwise be theirs.
void write_free_tables(std::string& text, const PlanSection& section, const Plan& plan) {
  for (const PlanKey& key : section.keys) {
    if (!std::holds_alternative<FreeTableKey>(key.type)) continue;
    const KeyValue value = key.place.get(plan, 0);
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
      if (!section.name.empty()) text += "\n" + header + "\n";
      write_keys(text, section, plan, row);
    }
    write_free_tables(text, section, plan);
  }
  return text;
}

}  // namespace todbench
