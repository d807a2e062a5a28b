// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/cli/findings.h"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "tod/comparison/paired_ratio.h"

namespace todbench {

void print_findings(const Console& console, const std::optional<Adequacy>& adequacy, std::string_view about) {
  if (!adequacy) return;
  for (const AdequacyFinding& finding : adequacy->findings)
    console.text((finding.unfit ? "not fit for a decision: " : "finding: ") + std::string(about) + finding.sentence);
}

void print_frontier(const Console& console, const std::vector<PrecisionChoice>& choices) {
  std::vector<TableRow> rows;
  for (const PrecisionChoice& choice : choices) {
    std::string remark = choice.planned ? "planned" : "";
    if (choice.recommended) remark += remark.empty() ? "recommended" : ", recommended";
    TableRow row{std::string(to_string(choice.answers)), fmt::format("{}", fmt::join(choice.frames, ", ")),
                 fixed(choice.seconds, 0), fixed(choice.half_width_percent, 2)};
    for (const ContrastPrediction& contrast : choice.contrasts) row.push_back(fixed(contrast.uncertainty_percent, 2));
    row.push_back(std::move(remark));
    rows.push_back(std::move(row));
  }
  if (rows.empty()) return;
  TableRow header{"answers", "frames", "time [s]", "95 % half-width [%]"};
  for (const ContrastPrediction& contrast : choices.front().contrasts)
    header.push_back("at " + fixed(contrast.delta_t_k, 2) + " K");
  header.emplace_back("");
  console.text("");
  console.text(
      "precision of S75 by number of frames and kind of answers; half-width: the largest of all contrasts, not "
      "exceeded in 19 of 20 runs:");
  console.table(header, rows);
}

void print_paired(const Console& console, const Comparison& comparison, bool measured_once) {
  std::vector<TableRow> rows;
  for (const ComparisonPoint& point : comparison.points) {
    if (!point.paired) continue;
    const RatioOfPairs& paired = *point.paired;
    rows.push_back({fixed(point.delta_t_a_k, 3), fixed(paired.ratio, 4), range(paired.ci95, 4), range(paired.ci90, 4),
                    fixed(paired.p_difference, 4), fixed(paired.p_equivalence, 4),
                    std::string(to_string(paired.verdict))});
  }
  if (rows.empty()) return;
  console.text("");
  console.text("paired by presentation; the verdict is based on these ratios:");
  console.table({"dT [K]", "ratio", "95 %", "90 %", "p difference", "p equivalence", "verdict"}, rows);
  console.text(not_cancelled_by_pairs(measured_once));
}

}  // namespace todbench
