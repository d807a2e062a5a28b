// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/uncertainty_section.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <span>
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
      row.push_back(plain(found->nu_eff ? significant(*found->nu_eff, 3) : "∞"));
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

/// " K, rectangular: / √3"
std::string unit_and_distribution(const BudgetRow& row) {
  const std::string unit = row.unit.empty() || row.unit == "1" ? "" : " " + row.unit, divisor = divisor_of(row);
  return fmt::format("{}, {}{}", unit, to_string(row.distribution), divisor == "1" ? "" : ": / " + divisor);
}

/// A contribution in percent. Shares are stated to 0.1 %, so that less than 0.001 % is no row of anybody's concern.
std::string percent_of(double contribution) {
  constexpr double least_percent = 0.001;
  return 100 * contribution < least_percent ? "< 0.001" : significant(100 * contribution, 3);
}

/// Largest number of contrasts in one table: a page has no room for more columns.
constexpr std::size_t contrasts_in_a_table = 4;

/// A row of the budget at some contrasts; null where the budget of a contrast lacks it.
struct RowOverContrasts {
  std::vector<const AppliedRow*> at;
  [[nodiscard]] const AppliedRow& any() const { return **std::find_if(at.begin(), at.end(), std::identity()); }
  /// The text at each contrast, once if it is the same at all.
  [[nodiscard]] std::string words(const std::function<std::string(const AppliedRow&)>& text) const {
    std::vector<std::string> texts;
    for (const AppliedRow* row : at)
      if (row != nullptr) texts.push_back(text(*row));
    const bool same = std::all_of(texts.begin(), texts.end(), [&](const std::string& one) { return one == texts[0]; });
    return same ? texts[0] : fmt::format("{}", fmt::join(texts, " | "));
  }
};

/// Rows of the same name, input and source at all contrasts, in the order in which they appear.
std::vector<RowOverContrasts> joined_rows(std::span<const PointUncertainty> points) {
  std::vector<RowOverContrasts> joined;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (const AppliedRow& row : points[i].rows) {
      const auto same = [&](const RowOverContrasts& one) {
        const AppliedRow& first = one.any();
        return one.at[i] == nullptr && first.input == row.input && first.row.name == row.row.name &&
               first.row.source == row.row.source && first.row.common == row.row.common &&
               first.row.unit == row.row.unit && first.row.distribution == row.row.distribution;
      };
      auto found = std::find_if(joined.begin(), joined.end(), same);
      if (found == joined.end())
        found = joined.insert(found, RowOverContrasts{std::vector<const AppliedRow*>(points.size())});
      found->at[i] = &row;
    }
  }
  return joined;
}

std::vector<RichText> cells(const RowOverContrasts& joined) {
  const AppliedRow& any = joined.any();
  const std::string_view enters = to_string(any.input);
  std::vector<RichText> row{
      plain(any.row.name == enters ? any.row.name : any.row.name + fmt::format(" (input: {})", enters)),
      plain(joined.words([](const AppliedRow& one) { return significant(one.row.value, 3); }) +
            unit_and_distribution(any.row)),
      plain(joined.words([](const AppliedRow& one) {
        return one.row.degrees_of_freedom ? significant(*one.row.degrees_of_freedom, 3) : "∞";
      })),
      plain(joined.words([](const AppliedRow& one) {
        return one.row.sensitivity ? fmt::format("{:.3g}", *one.row.sensitivity) : "not known";
      }))};
  for (const AppliedRow* one : joined.at) {
    row.push_back(one == nullptr
                      ? missing("no row")
                      : unbroken(fmt::format("{} ({})", percent_of(one->contribution), shown(one->share_percent, 1))));
  }
  RichText source = text_or_missing(source_of(any.row), "not stated");
  if (const std::string common = common_of(any.row); !common.empty()) source += plain("; " + common);
  row.push_back(std::move(source));
  return row;
}

Table rows_table(std::span<const PointUncertainty> points) {
  Table rows;
  rows.caption =
      "Budget of ln acuity: contribution in % and, in brackets, share of the variance in % at each set contrast";
  rows.header = {"Row", "Value", "ν", "Sensitivity"};
  for (const PointUncertainty& point : points) rows.header.push_back(stated(point.set_delta_t_k) + " K");
  rows.header.emplace_back("Source; common to");
  for (const RowOverContrasts& joined : joined_rows(points)) rows.rows.push_back(cells(joined));
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
  const std::span points(data.uncertainty->points);
  for (std::size_t i = 0; i < points.size(); i += contrasts_in_a_table)
    section.blocks.emplace_back(rows_table(points.subspan(i, std::min(contrasts_in_a_table, points.size() - i))));
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
