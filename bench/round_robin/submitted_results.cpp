// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/round_robin/submitted_results.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "acquisition/base/normal.h"
#include "acquisition/base/try.h"
#include "bench/history/history_session.h"
#include "bench/session/open_session.h"
#include "bench/text/csv_table.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

enum Column : std::size_t { laboratory, item, quantity, value, unit, u, expanded_u, k, ci95_low, ci95_high, columns };
const std::vector<std::string> column_names{"laboratory", "item",       "quantity", "value",    "unit",
                                            "u",          "expanded_u", "k",        "ci95_low", "ci95_high"};
using Places = std::array<std::optional<std::size_t>, columns>;

/// Squares of numbers and of their ratios stay finite.
constexpr double largest = 1e30, smallest = 1e-30;

Result<Places> places_of(const CsvTable& table) {
  Places places;
  for (std::size_t i = 0; i < table.header.size(); ++i) {
    const auto found = std::find(column_names.begin(), column_names.end(), table.header[i]);
    if (found == column_names.end()) {
      return table.wrong(1, "unknown column '" + one_line(table.header[i]) + "'" +
                                nearest_name_hint(table.header[i], column_names) +
                                " (known: " + quoted_list(column_names) + ")");
    }
    auto& place = places[static_cast<std::size_t>(found - column_names.begin())];
    if (place) return table.wrong(1, "column '" + *found + "' occurs twice");
    place = i;
  }
  for (const Column needed : {laboratory, item, quantity, value}) {
    if (!places[needed]) return table.wrong(1, "missing column '" + column_names[needed] + "'");
  }
  if (places[ci95_low].has_value() != places[ci95_high].has_value())
    return table.wrong(1, "an interval needs both columns, ci95_low and ci95_high");
  if (places[k] && !places[expanded_u]) return table.wrong(1, "column k needs the column expanded_u");
  if (!places[u] && !places[expanded_u] && !places[ci95_low])
    return table.wrong(1, "missing uncertainty: expected a column u, expanded_u, or ci95_low and ci95_high");
  return places;
}

/// One row of the file.
class RowReader {
 public:
  RowReader(const CsvTable& table, const CsvRow& row, const Places& places)
      : table_(table), row_(row), places_(places) {}

  [[nodiscard]] std::string text(Column column) const { return places_[column] ? row_.fields[*places_[column]] : ""; }
  [[nodiscard]] Result<std::string> name(Column column) const {
    const std::string found = text(column);
    if (found.empty() || found.size() > 100) return wrong(column, "a name of at most 100 bytes");
    return one_line(found);
  }
  [[nodiscard]] Result<double> number(Column column) const {
    const auto found = parse_number(text(column));
    if (!found || !(std::abs(*found) <= largest)) return wrong(column, "a number from -1e30 to 1e30");
    return *found;
  }
  [[nodiscard]] Result<double> positive(Column column) const {
    const auto found = parse_number(text(column));
    if (!found || !(*found >= smallest && *found <= largest))
      return wrong(column, "a number above 0, from 1e-30 to 1e30");
    return *found;
  }
  [[nodiscard]] Result<double> uncertainty(double of_value) const {
    const bool standard = !text(u).empty(), expanded = !text(expanded_u).empty(),
               interval = !text(ci95_low).empty() || !text(ci95_high).empty();
    if (standard + expanded + interval != 1)
      return table_.wrong(row_.line, standard + expanded + interval == 0
                                         ? "missing uncertainty: expected u, expanded_u, or ci95_low and ci95_high"
                                         : "expected one uncertainty, found several");
    if (standard) return positive(u);
    if (expanded) {
      TODBENCH_TRY(const double wide, positive(expanded_u));
      TODBENCH_TRY(const double factor, text(k).empty() ? Result<double>(2.0) : positive(k));
      return in_range(expanded_u, wide / factor);
    }
    TODBENCH_TRY(const double low, number(ci95_low));
    TODBENCH_TRY(const double high, number(ci95_high));
    if (!(low <= of_value && of_value <= high)) return wrong(ci95_low, "an interval that contains the value");
    return in_range(ci95_high, (high - low) / (2 * normal_z95));
  }

 private:
  [[nodiscard]] Result<double> in_range(Column column, double found) const {
    if (!(found >= smallest && found <= largest)) return wrong(column, "a standard uncertainty from 1e-30 to 1e30");
    return found;
  }
  [[nodiscard]] tl::unexpected<Error> wrong(Column column, const std::string& expected) const {
    return table_.wrong(row_.line, "column " + column_names[column] + ": expected " + expected + ", found '" +
                                       one_line(text(column)) + "'");
  }
  const CsvTable& table_;
  const CsvRow& row_;
  const Places& places_;
};

/// Relative variance of an acuity that is common to a series of units of one bench. It cancels in the history of that
/// bench, but not between laboratories.
double series_variance(const Session& session, const HistoryValue& acuity) {
  if (!session.uncertainty || acuity.measure != "acuity") return 0;
  for (const PointUncertainty& point : session.uncertainty->points) {
    if (acuity.condition != "dT=" + number_text(point.set_delta_t_k) + "K") continue;
    return std::max(0.0, point.u_stated * point.u_stated - point.u_not_series * point.u_not_series);
  }
  return 0;
}

}  // namespace

Result<std::vector<SubmittedResult>> parse_submitted_results(std::string_view text, std::string_view name) {
  TODBENCH_TRY(const CsvTable table, parse_csv(text, name));
  TODBENCH_TRY(const Places places, places_of(table));
  std::vector<SubmittedResult> out;
  for (const CsvRow& row : table.rows) {
    const RowReader reader(table, row, places);
    SubmittedResult found;
    TODBENCH_TRY(found.laboratory, reader.name(laboratory));
    TODBENCH_TRY(found.item, reader.name(item));
    TODBENCH_TRY(found.quantity, reader.name(quantity));
    found.unit = one_line(reader.text(unit));
    TODBENCH_TRY(found.value, reader.number(value));
    TODBENCH_TRY(found.u, reader.uncertainty(found.value));
    found.source = std::string(name) + ":" + std::to_string(row.line);
    out.push_back(std::move(found));
  }
  if (out.empty()) return table.wrong(1, "expected at least one row");
  return out;
}

Result<std::vector<SubmittedResult>> session_results(const std::filesystem::path& folder) {
  TODBENCH_TRY(const Session session, open_session(folder, {}));
  TODBENCH_TRY(const HistorySession history, read_history_session(folder));
  const Plan& plan = session.plan;
  for (const auto& [key, named, as] :
       {std::tuple("place", &plan.place, "laboratory"), std::tuple("unit", &plan.unit, "item")}) {
    if (named->empty()) {
      return fail(ErrorCode::invalid_input, folder.string() + ": the plan of the session states no " + key +
                                                ", which names the " + as + " of a comparison");
    }
  }
  std::vector<SubmittedResult> out;
  for (const HistoryValue& found : history.values) {
    const bool logarithm = found.scale == "ln";
    const double linear = logarithm ? std::exp(found.value) : found.value;
    const double uncertainty =
        logarithm ? linear * std::sqrt(found.u * found.u + series_variance(session, found)) : found.u;
    if (!std::isfinite(linear) || !(uncertainty >= smallest && uncertainty <= largest)) continue;
    const std::string condition = one_line(stated_condition(history, found));
    out.push_back({one_line(plan.place), one_line(plan.unit),
                   found.measure + (condition.empty() ? "" : " at " + condition), found.unit, linear, uncertainty,
                   folder.string()});
  }
  if (out.empty())
    return fail(ErrorCode::invalid_input, folder.string() + ": no value of the session has an uncertainty");
  return out;
}

Result<std::vector<ComparedItem>> compared_items(const std::vector<SubmittedResult>& results) {
  struct Group {
    std::string unit, first_source;
    std::map<std::string, std::pair<LaboratoryValue, std::string>> by_laboratory;
  };
  std::map<std::pair<std::string, std::string>, Group> groups;
  for (const SubmittedResult& r : results) {
    const auto [at, first] = groups.try_emplace({r.item, r.quantity});
    Group& group = at->second;
    if (first) {
      group.unit = r.unit;
      group.first_source = r.source;
    } else if (group.unit != r.unit) {
      return fail(ErrorCode::invalid_input, r.source + ": item '" + r.item + "', quantity '" + r.quantity +
                                                "': unit '" + r.unit + "' differs from '" + group.unit + "' in " +
                                                group.first_source);
    }
    const auto [there, fresh] =
        group.by_laboratory.try_emplace(r.laboratory, LaboratoryValue{r.laboratory, r.value, r.u}, r.source);
    if (!fresh) {
      return fail(ErrorCode::invalid_input, r.source + ": laboratory '" + r.laboratory +
                                                "' has a second result of item '" + r.item + "', quantity '" +
                                                r.quantity + "' (first: " + there->second.second + ")");
    }
  }
  std::vector<ComparedItem> out;
  for (auto& [name, group] : groups) {
    ComparedItem made{name.first, name.second, group.unit, {}};
    for (auto& [laboratory_name, result] : group.by_laboratory) made.results.push_back(std::move(result.first));
    out.push_back(std::move(made));
  }
  return out;
}

}  // namespace todbench
