// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/uncertainty_section.h"

#include <fmt/format.h>

#include <string_view>
#include <utility>

#include "bench/report/number_format.h"
#include "bench/report/report_pieces.h"
#include "tod/psychometric/acuity.h"

namespace todbench {
namespace {

std::string divisor_of(const BudgetRow& row) {
  switch (row.distribution) {
    case BudgetDistribution::normal:
      return stated(row.coverage_factor);
    case BudgetDistribution::rectangular:
      return "√3";
    case BudgetDistribution::triangular:
      return "√6";
    case BudgetDistribution::u_shaped:
      return "√2";
  }
  return "";
}

std::string common_of(const BudgetRow& row) {
  std::string text;
  for (const BudgetCommon common : row.common) text += (text.empty() ? "" : ", ") + std::string(to_string(common));
  return text;
}

std::string source_of(const BudgetRow& row) {
  if (row.certificate.empty()) return row.source;
  return row.source + (row.source.empty() ? "" : ", ") + "certificate " + row.certificate;
}

Table summary_table(const CurveUncertainty& uncertainty) {
  Table rows;
  rows.caption = "Acuity (1/mrad): statistical and expanded 95 % intervals";
  rows.header = {"Set ΔT (K)",         "d ln acuity / d ln ΔT", "Statistical", "Expanded",
                 "u of ln acuity (%)", "ν effective",           "k",           "U, GUM (%)",
                 "U, Monte Carlo (%)"};
  for (const PointUncertainty& point : uncertainty.points) {
    const auto interval = [](const Interval& s75_mrad) {
      return interval_or_missing(std::nullopt, acuity_interval(s75_mrad), "not identified");
    };
    std::vector<RichText> row{plain(stated(point.set_delta_t_k)), plain(significant(point.contrast_slope, 2)),
                              interval(point.statistical_mrad), interval(point.expanded_mrad)};
    if (const auto& found = point.combined) {
      row.push_back(plain(significant(100 * found->u, 3)));
      row.push_back(plain(found->nu_eff ? significant(*found->nu_eff, 3) : "infinite"));
      row.push_back(plain(significant(found->k, 4)));
      row.push_back(plain(significant(100 * found->expanded_gum, 3)));
      row.push_back(plain(significant(100 * found->expanded_monte_carlo, 3)));
    } else {
      for (int i = 0; i < 5; ++i) row.push_back(missing("not identified"));
    }
    rows.rows.push_back(std::move(row));
  }
  return rows;
}

Table rows_table(const PointUncertainty& point) {
  Table rows;
  rows.caption = "Budget of ln acuity at a set contrast of " + stated(point.set_delta_t_k) + " K";
  rows.header = {"Row", "Value", "ν", "Sensitivity", "Contribution (%)", "Share (%)", "Source; common to"};
  for (const AppliedRow& applied : point.rows) {
    const BudgetRow& row = applied.row;
    const std::string unit = row.unit.empty() || row.unit == "1" ? "" : " " + row.unit;
    const std::string_view enters = to_string(applied.input);
    const std::string divisor = divisor_of(row), common = common_of(row);
    RichText source = text_or_missing(source_of(row), "not stated");
    if (!common.empty()) source += plain("; " + common);
    rows.rows.push_back(
        {plain(row.name == enters ? row.name : row.name + fmt::format(" (input: {})", enters)),
         unbroken(significant(row.value, 3) + unit) +
             plain(fmt::format(", {}{}", to_string(row.distribution), divisor == "1" ? "" : ": / " + divisor)),
         plain(row.degrees_of_freedom ? significant(*row.degrees_of_freedom, 3) : "infinite"),
         row.sensitivity ? plain(significant(*row.sensitivity, 3)) : missing("not known"),
         plain(significant(100 * applied.contribution, 3)), plain(shown(applied.share_percent, 1)), std::move(source)});
  }
  return rows;
}

}  // namespace

std::optional<Section> uncertainty_section(const ReportData& data) {
  if (!data.uncertainty) return std::nullopt;
  Section section{"Uncertainty", {summary_table(*data.uncertainty)}};
  if (!data.uncertainty->not_stated.empty()) {
    std::string names;
    for (const std::string& name : data.uncertainty->not_stated) names += (names.empty() ? "" : ", ") + name;
    section.blocks.emplace_back(
        Paragraph{strong("Not stated, so not included in the expanded intervals:") + plain(" " + names)});
  }
  for (const PointUncertainty& point : data.uncertainty->points) section.blocks.emplace_back(rows_table(point));
  section.blocks.emplace_back(note(plain(
      "The rows are combined in ln acuity (JCGM 100:2008). Relative errors of geometry enter directly, errors of "
      "contrast by the slope of the measured curve. Degrees of freedom follow Welch and Satterthwaite; k is that of "
      "Student's t for 95 %. The result is checked by 200 000 draws (JCGM 101:2008) with the seed of the plan. Each "
      "side of the expanded interval is the largest of the GUM value, the draws and the statistical interval. Limits "
      "are judged by the expanded interval. Rows common to camera and twin cancel in their ratio. Rows common to a "
      "series cancel in its trend. Rows common to contrasts cancel in the shape of the curve.")));
  return section;
}

}  // namespace todbench
