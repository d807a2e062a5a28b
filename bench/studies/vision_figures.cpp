// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/studies/vision_figures.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>

#include "acquisition/base/number_range.h"
#include "acquisition/base/try.h"
#include "bench/text/csv_table.h"
#include "bench/text/text.h"
#include "hvs/eye/compact_patterns.h"

namespace todbench {
namespace {

/// A column of numbers: its name and the range of an eye's experiments.
struct FigureColumn {
  std::string_view name;
  NumberRange range;
};
constexpr FigureColumn luminance_column{"luminance_cd_m2", NumberRange::between(1e-3, 1e5)},
    sensitivity_column{"sensitivity", NumberRange::above_to(0, 1e4)},
    frequency_column{"frequency_cpd", NumberRange::above_to(0, 100)},
    sigma_column{"sigma_deg", NumberRange::above_to(0, 20)}, area_column{"area_deg2", NumberRange::above_to(0, 1000)},
    d_prime_column{"d_prime", NumberRange::between(0.1, 10)},
    percent_column{"contrast_percent", NumberRange::above_to(0, 100)},
    acuity_column{"decimal_acuity", NumberRange::above_to(0, 10)};

bool has_column(const CsvTable& table, const FigureColumn& column) {
  return table.column(column.name).has_value();
}

Result<double> number_of(const CsvTable& table, const CsvRow& row, const FigureColumn& column) {
  const auto at = table.column(column.name);
  const auto value = at ? parse_number(row.fields[*at]) : std::nullopt;
  if (value && column.range.contains(*value)) return *value;
  return table.wrong(row.line, fmt::format("{}: expected {}, found '{}'", column.name, column.range.describe(),
                                           at ? one_line(row.fields[*at]) : ""));
}

std::string text_of(const CsvTable& table, const CsvRow& row, std::string_view column, std::string_view otherwise) {
  const auto at = table.column(column);
  return at && !row.fields[*at].empty() ? one_line(row.fields[*at]) : std::string(otherwise);
}

/// Standard deviation of the window of a grating, or the radius of a disc.
Result<double> extent_of(const CsvTable& table, const CsvRow& row) {
  if (has_column(table, sigma_column)) return number_of(table, row, sigma_column);
  TODBENCH_TRY(const double area, number_of(table, row, area_column));
  return std::sqrt(area / std::numbers::pi);
}

Result<VisionPoint> sensitivity_point(const CsvTable& table, const CsvRow& row, const MeasuredEye& eye) {
  const std::string stimulus = text_of(table, row, "stimulus", "gabor");
  TODBENCH_TRY(const double luminance, number_of(table, row, luminance_column));
  TODBENCH_TRY(const double people, number_of(table, row, sensitivity_column));
  TODBENCH_TRY(const double extent, extent_of(table, row));
  double d_prime = two_alternatives;
  if (has_column(table, d_prime_column)) {
    TODBENCH_TRY(const double stated, number_of(table, row, d_prime_column));
    d_prime = stated;
  }
  if (stimulus == "disc" || stimulus == "disk")
    return VisionPoint{fmt::format("{:g} cd/m2, disc, radius {:.3g} deg", luminance, extent), people,
                       disc_d_prime(eye.at(luminance), extent) / d_prime};
  if (stimulus != "gabor" && stimulus != "grating") {
    return table.wrong(row.line, "stimulus: expected gabor, grating or disc, found '" + stimulus +
                                     "'; the program has no model of another");
  }
  TODBENCH_TRY(const double frequency, number_of(table, row, frequency_column));
  return VisionPoint{fmt::format("{:g} cd/m2, {:g} 1/deg, sigma {:.2g} deg", luminance, frequency, extent), people,
                     eye.at(luminance).gabor_d_prime(frequency, extent) / d_prime};
}

Result<VisionPoint> acuity_point(const CsvTable& table, const CsvRow& row, const MeasuredEye& eye) {
  TODBENCH_TRY(const double luminance, number_of(table, row, luminance_column));
  TODBENCH_TRY(const double percent, number_of(table, row, percent_column));
  TODBENCH_TRY(const double people, number_of(table, row, acuity_column));
  return VisionPoint{fmt::format("{:g} cd/m2, {:g} %", luminance, percent), people,
                     eye.acuity(luminance, percent / 100)};
}

VisionKind kind_of(const std::string& dataset, bool of_acuity, const std::filesystem::path& file) {
  VisionKind kind{.name = "figures",
                  .title = dataset.empty() ? std::string("Figures of the file") : dataset,
                  .quantity = "sensitivity (1 / contrast)",
                  .role = VisionRole::from_file,
                  .failure = {},
                  .source = file.filename().string(),
                  .remark = "Whether these figures were in the fit of the observer is not known here.",
                  .points = {}};
  if (!dataset.empty()) kind.name += ":" + dataset;
  if (of_acuity) {
    kind.quantity = "acuity (1/arcmin)";
    kind.error = VisionError::log10;
  }
  return kind;
}

}  // namespace

Result<std::vector<VisionKind>> figures_of_people(const std::filesystem::path& file, const MeasuredEye& eye) {
  TODBENCH_TRY(const std::string text, read_text_file(file));
  TODBENCH_TRY(const CsvTable table, parse_csv(text, file.string()));
  const bool of_acuity = has_column(table, percent_column) && has_column(table, acuity_column);
  const bool of_sensitivity =
      has_column(table, sensitivity_column) && (has_column(table, sigma_column) || has_column(table, area_column));
  if (!has_column(table, luminance_column) || of_acuity == of_sensitivity) {
    return table.wrong(1,
                       "expected the columns luminance_cd_m2, frequency_cpd, sigma_deg and sensitivity, or "
                       "luminance_cd_m2, contrast_percent and decimal_acuity");
  }
  if (table.rows.empty()) return table.wrong(1, "the file has no row");
  std::vector<VisionKind> kinds;
  for (const CsvRow& row : table.rows) {
    TODBENCH_TRY(VisionPoint point, of_acuity ? acuity_point(table, row, eye) : sensitivity_point(table, row, eye));
    if (!(point.model > 0))
      return table.wrong(row.line, "the observer does not see " + point.condition + " at any size or contrast");
    const VisionKind empty = kind_of(text_of(table, row, "dataset", ""), of_acuity, file);
    auto kind = std::ranges::find(kinds, empty.name, &VisionKind::name);
    if (kind == kinds.end()) kind = kinds.insert(kinds.end(), empty);
    kind->points.push_back(std::move(point));
  }
  return kinds;
}

}  // namespace todbench
