// SPDX-License-Identifier: GPL-3.0-or-later
// Reader of the file of `todbench budget`.
#include <utility>

#include "acquisition/base/try.h"
#include "bench/judgement/uncertainty_budget.h"
#include "bench/plan/plan_keys.h"
#include "bench/plan/strict_toml.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

/// Returns the section of budget rows: same keys and words as in a plan.
const PlanSection& row_section() {
  return *plan_key("uncertainty.component.name").section;
}

void read_row(TomlReader& table, const PlanSection& section, std::size_t row, Plan& rows) {
  for (const PlanKey& key : section.keys) {
    const std::string_view name = name_in(table, key);
    const bool needed = key.required == Required::always;
    key.place.set(rows, row,
                  read_value(key.type, table, name, needed ? std::nullopt : std::optional(key.place.get(rows, row))));
  }
}

}  // namespace

Result<UncertaintyBudget> parse_budget(std::string_view text, const std::string& name) {
  TODBENCH_TRY(auto reader, TomlReader::parse(text, name));
  UncertaintyBudget budget;
  budget.quantity = reader.text("quantity", "");
  budget.unit = reader.text("unit", "");
  const PlanSection& section = row_section();
  std::vector<TomlReader> tables = rows_in(reader, section);
  Plan rows;
  section.rows.resize(rows, tables.size());
  for (std::size_t row = 0; row < tables.size(); ++row) read_row(tables[row], section, row, rows);
  budget.rows = std::move(rows.uncertainty.rows);
  TODBENCH_TRY_VOID(reader.finish());
  return budget;
}

Result<UncertaintyBudget> read_budget(const std::filesystem::path& file) {
  TODBENCH_TRY(const auto text, read_text_file(file));
  return parse_budget(text, file.string());
}

}  // namespace todbench
