#include "bench/cli/findings.h"

#include <string>
#include <vector>

#include "tod/comparison/paired_ratio.h"

namespace todbench {

void print_findings(const Console& console, const std::optional<Adequacy>& adequacy, std::string_view about) {
  if (!adequacy) return;
  for (const AdequacyFinding& finding : adequacy->findings)
    console.text((finding.unfit ? "not fit for a decision: " : "finding: ") + std::string(about) + finding.sentence);
}

void print_paired(const Console& console, const Comparison& comparison) {
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
  console.text("paired by presentation; these ratios decide:");
  console.table({"dT [K]", "ratio", "95 %", "90 %", "p difference", "p equivalence", "verdict"}, rows);
  console.text(std::string(not_cancelled_by_pairs));
}

}  // namespace todbench
