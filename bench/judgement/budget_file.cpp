// The file of `todbench budget`.
#include <algorithm>

#include "bench/judgement/uncertainty_budget.h"
#include "bench/plan/strict_toml.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

/// Words of a distribution; the second form says what the value is.
struct DistributionWord {
  std::string_view word;
  BudgetDistribution distribution;
};
constexpr std::array distribution_words{
    DistributionWord{"normal", BudgetDistribution::normal},
    DistributionWord{"rectangular", BudgetDistribution::rectangular},
    DistributionWord{"rectangular half-width", BudgetDistribution::rectangular},
    DistributionWord{"triangular", BudgetDistribution::triangular},
    DistributionWord{"triangular half-width", BudgetDistribution::triangular},
    DistributionWord{"u-shaped", BudgetDistribution::u_shaped},
    DistributionWord{"u-shaped half-width", BudgetDistribution::u_shaped},
};

/// The first of the names that the table has; the last where it has none.
std::string_view name_of(const TomlReader& table, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) {
    if (table.has(name)) return name;
  }
  return *std::prev(names.end());
}

BudgetRow read_row(TomlReader& table) {
  std::vector<std::string> words;
  for (const auto& known : distribution_words) words.emplace_back(known.word);
  BudgetRow row;
  row.name = table.text("name", std::nullopt);
  row.value = table.number("value", NumberRange::not_negative(), std::nullopt);
  const std::string word = table.choice(name_of(table, {"kind", "distribution"}), words, "normal");
  for (const auto& known : distribution_words) {
    if (known.word == word) row.distribution = known.distribution;
  }
  row.coverage_factor = table.number("coverage_factor", NumberRange::positive(), 1);
  row.degrees_of_freedom = table.number_or(name_of(table, {"nu", "degrees_of_freedom"}), NumberRange::between(1, 1e300),
                                           "infinite", std::nullopt);
  row.sensitivity = table.optional_number("sensitivity", NumberRange::any());
  row.unit = table.text("unit", "");
  row.source = table.text("source", "");
  row.certificate = table.text("certificate", "");
  std::vector<std::string> commons;
  for (const BudgetCommon common : budget_commons) commons.emplace_back(to_string(common));
  for (const std::string& name : table.choices("common", commons, std::vector<std::string>{})) {
    for (const BudgetCommon common : budget_commons) {
      if (to_string(common) == name) row.common.push_back(common);
    }
  }
  return row;
}

}  // namespace

Result<UncertaintyBudget> parse_budget(std::string_view text, const std::string& name) {
  auto reader = TomlReader::parse(text, name);
  if (!reader) return tl::unexpected(reader.error());
  UncertaintyBudget budget;
  budget.quantity = reader->text("quantity", "");
  budget.unit = reader->text("unit", "");
  for (TomlReader& table : reader->sections(name_of(*reader, {"components", "rows", "row", "component"})))
    budget.rows.push_back(read_row(table));
  if (auto finished = reader->finish(); !finished) return tl::unexpected(finished.error());
  return budget;
}

Result<UncertaintyBudget> read_budget(const std::filesystem::path& file) {
  const auto text = read_text_file(file);
  if (!text) return tl::unexpected(text.error());
  return parse_budget(*text, file.string());
}

}  // namespace todbench
