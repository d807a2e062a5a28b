#include "bench/cli/findings.h"

#include <string>

namespace todbench {

void print_findings(const Console& console, const std::optional<Adequacy>& adequacy, std::string_view about) {
  if (!adequacy) return;
  for (const AdequacyFinding& finding : adequacy->findings)
    console.text((finding.unfit ? "not fit for a decision: " : "finding: ") + std::string(about) + finding.sentence);
}

}  // namespace todbench
