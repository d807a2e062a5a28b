// SPDX-License-Identifier: GPL-3.0-or-later
// Section on the display of the operator: what limits the acuity, thresholds of a person.
#include <cmath>

#include "bench/report/number_format.h"
#include "bench/report/report_pieces.h"

namespace todbench {
namespace {

Table limits_table(const DisplayRecord& record) {
  Table table;
  table.caption = "What limits the acuity: increase of S75 against the same without one factor, in percent";
  table.header = {"Contrast [K]", "Limited most by", "Sampling", "Sensor noise", "Display", "Eye", "Light"};
  for (const AcuityLimits& at : record.limits) {
    std::vector<RichText> row{plain(significant(at.delta_t_k, 3)), at.costs.empty()
                                                                       ? missing("nothing can be left out")
                                                                       : plain(to_string(at.costs.front().factor))};
    for (const LimitingFactor factor : all_limiting_factors) {
      if (factor == LimitingFactor::observer) continue;  // the record is of an observer with an eye
      RichText cell = missing("not estimated");
      for (const FactorCost& cost : at.costs) {
        if (cost.factor == factor) cell = plain(shown(std::round(cost.percent) + 0.0, 0));
      }
      row.push_back(std::move(cell));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table points_table(const DisplayRecord& record) {
  Table table;
  table.caption = "As an operator at this display would see it: " + record.observer;
  table.header = {"Contrast [K]", "S75 [mrad]", "Spread over open parameters [mrad]"};
  for (const DisplayedPoint& point : record.points) {
    table.rows.push_back({plain(significant(point.delta_t_k, 3)), plain(significant(point.s75_mrad, 4)),
                          point.spread_mrad ? unbroken(significant(point.spread_mrad->first, 3) + " to " +
                                                       significant(point.spread_mrad->second, 3))
                                            : missing("no threshold at an end of the parameters")});
  }
  return table;
}

}  // namespace

std::optional<Section> viewing_section(const ReportData& data) {
  if (!data.at_display || (data.at_display->points.empty() && data.at_display->limits.empty())) return std::nullopt;
  const DisplayRecord& record = *data.at_display;
  Section section{"Operator at the display", {}};
  if (!record.points.empty()) {
    section.blocks.emplace_back(points_table(record));
    section.blocks.emplace_back(
        note(plain(record.observer + " is not a validated model of people. The spread is that of its parameters that "
                                     "public data leave open, and no confidence interval. No verdict uses it.")));
  }
  if (!record.limits.empty()) section.blocks.emplace_back(limits_table(record));
  section.blocks.emplace_back(
      note(plain("Estimated for the simulated sensor, without trials. The limits have an error of about 1 percent.")));
  return section;
}

}  // namespace todbench
