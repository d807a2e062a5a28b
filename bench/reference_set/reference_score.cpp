// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/reference_set/reference_score.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "acquisition/base/try.h"
#include "bench/text/csv_table.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

constexpr std::size_t columns = 4;

/// Position of each column.
using Columns = std::array<std::optional<std::size_t>, columns>;

Result<Columns> columns_of(const CsvTable& table) {
  static const std::vector<std::string> known{"case", "s75_mrad", "s75_ci95_low_mrad", "s75_ci95_high_mrad"};
  Columns places;
  for (std::size_t i = 0; i < table.header.size(); ++i) {
    const auto found = std::find(known.begin(), known.end(), table.header[i]);
    if (found == known.end()) {
      return table.wrong(1, "unknown column '" + one_line(table.header[i]) + "'" +
                                nearest_name_hint(table.header[i], known) + " (known: " + quoted_list(known) + ")");
    }
    auto& place = places[static_cast<std::size_t>(found - known.begin())];
    if (place) return table.wrong(1, "column '" + *found + "' occurs twice");
    place = i;
  }
  for (std::size_t k = 0; k < 2; ++k) {
    if (!places[k]) return table.wrong(1, "missing column '" + known[k] + "'");
  }
  if (places[2].has_value() != places[3].has_value())
    return table.wrong(1, "an interval needs both columns, s75_ci95_low_mrad and s75_ci95_high_mrad");
  return places;
}

Result<ReferenceResult> result_of(const CsvTable& table, const CsvRow& row, const Columns& places) {
  const auto wrong = [&](std::size_t column, const std::string& expected) {
    return table.wrong(row.line, "column " + table.header[column] + ": expected " + expected + ", found '" +
                                     one_line(row.fields[column]) + "'");
  };
  ReferenceResult out{.name = row.fields[*places[0]], .s75_mrad = 0, .ci95_mrad = {}};
  const auto size = parse_number(row.fields[*places[1]]);
  if (!size || !(*size > 0)) return wrong(*places[1], "a number above 0");
  out.s75_mrad = *size;
  if (!places[2] || (row.fields[*places[2]].empty() && row.fields[*places[3]].empty())) return out;
  const auto low = parse_number(row.fields[*places[2]]), high = parse_number(row.fields[*places[3]]);
  if (!low || !(*low >= 0 && *low <= *size)) return wrong(*places[2], "a number from 0 to s75_mrad");
  if (!high || !(*high >= *size)) return wrong(*places[3], "a number of at least s75_mrad");
  out.ci95_mrad = Interval{*low, *high};
  return out;
}

}  // namespace

Result<std::vector<ReferenceResult>> parse_reference_result(std::string_view text, std::string_view name,
                                                            std::span<const ReferenceTruth> truths) {
  TODBENCH_TRY(const auto table, parse_csv(text, name));
  TODBENCH_TRY(const auto places, columns_of(table));
  std::vector<std::string> known;
  for (const ReferenceTruth& truth : truths) known.push_back(truth.name);
  std::vector<std::optional<ReferenceResult>> found(truths.size());
  for (const CsvRow& row : table.rows) {
    TODBENCH_TRY(auto result, result_of(table, row, places));
    const auto at = std::find(known.begin(), known.end(), result.name);
    if (at == known.end()) {
      return table.wrong(row.line,
                         "unknown case '" + one_line(result.name) + "'" + nearest_name_hint(result.name, known));
    }
    auto& slot = found[static_cast<std::size_t>(at - known.begin())];
    if (slot) return table.wrong(row.line, "case '" + *at + "' occurs twice");
    slot = std::move(result);
  }
  std::vector<ReferenceResult> out;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (!found[i])
      return fail(ErrorCode::invalid_input, std::string(name) + ": missing row of case '" + known[i] + "'");
    out.push_back(*std::move(found[i]));
  }
  return out;
}

ReferenceScore score(std::span<const ReferenceTruth> truths, std::span<const ReferenceResult> results) {
  ReferenceScore out;
  out.passed = true;
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < truths.size(); ++i) {
    CaseScore one{.truth = truths[i], .result = results[i], .interval_holds = {}};
    one.deviation_percent = 100 * (results[i].s75_mrad / truths[i].s75_mrad - 1);
    one.within = std::abs(one.deviation_percent) <= reference_tolerance_percent;
    if (const auto& ci = results[i].ci95_mrad)
      one.interval_holds = *ci->low <= truths[i].s75_mrad && *ci->high >= truths[i].s75_mrad;
    sum += std::log(results[i].s75_mrad / truths[i].s75_mrad);
    squares += one.deviation_percent * one.deviation_percent;
    out.passed = out.passed && one.within;
    out.cases.push_back(std::move(one));
  }
  const auto n = static_cast<double>(std::max<std::size_t>(1, truths.size()));
  out.mean_deviation_percent = 100 * std::expm1(sum / n);
  out.rms_deviation_percent = std::sqrt(squares / n);
  return out;
}

}  // namespace todbench
