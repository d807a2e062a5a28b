// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/psychometric/finding.h"

namespace todbench {

std::string_view to_string(FindingKind kind) {
  switch (kind) {
    case FindingKind::deviance:
      return "deviance";
    case FindingKind::lapse:
      return "lapse";
    case FindingKind::overdispersion:
      return "overdispersion";
    case FindingKind::underdispersion:
      return "underdispersion";
    case FindingKind::extrapolation:
      return "extrapolation";
    case FindingKind::slope:
      return "slope";
    case FindingKind::direct_estimate:
      return "direct_estimate";
    case FindingKind::clipping:
      return "clipping";
    case FindingKind::rounding:
      return "rounding";
    case FindingKind::temporal_correlation:
      return "temporal_correlation";
    case FindingKind::surrogate:
      return "surrogate";
    case FindingKind::identity:
      return "identity";
    case FindingKind::contrast_deviation:
      return "contrast_deviation";
    case FindingKind::transfer_change:
      return "transfer_change";
    case FindingKind::noise_change:
      return "noise_change";
    case FindingKind::correlation_change:
      return "correlation_change";
    case FindingKind::picture_residue:
      return "picture_residue";
    case FindingKind::setting_change:
      return "setting_change";
    case FindingKind::orientation:
      return "orientation";
    case FindingKind::ramp_direction:
      return "ramp_direction";
    case FindingKind::contrast_lag:
      return "contrast_lag";
  }
  return "unknown";
}

std::string reasons_unfit(const Adequacy& adequacy) {
  std::string reasons;
  for (const AdequacyFinding& finding : adequacy.findings) {
    if (!finding.unfit) continue;
    if (!reasons.empty()) reasons += "; ";
    reasons += finding.sentence;
  }
  return reasons;
}

}  // namespace todbench
