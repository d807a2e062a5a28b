// SPDX-License-Identifier: GPL-3.0-or-later
// Findings against a result, with their values and limits.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace todbench {

/// Subject of a finding. Each comment describes the subject, then the meaning of value and limit.
enum class FindingKind {
  deviance,              ///< shape of the answers differs from the model; standard deviations in the stated direction
  lapse,                 ///< a free lapse describes the answers better; 2 ln likelihood ratio, corrected for clusters
  overdispersion,        ///< answers scatter more than chance; ratio of variances
  underdispersion,       ///< answers scatter less than chance; ratio of variances
  extrapolation,         ///< threshold outside the tested sizes; size, nearest tested size
  slope,                 ///< slope at a limit of its domain; slope, limit of the domain
  direct_estimate,       ///< fit differs from the direct estimate, which uses no trials; difference in percent,
                         ///< tolerance for both
  clipping,              ///< saturated pixels in windows of triangles; share of trials
  rounding,              ///< a count is larger than the noise; standard deviation of the noise in counts
  temporal_correlation,  ///< successive frames share noise; correlation
  surrogate,             ///< the optics model of the twin does not describe the pictures; chi-square, its limit
  identity,  ///< curves of different plates, of the same answers, or fitted with different functions; no figures
  contrast_deviation,  ///< effective contrast differs from the set contrast; percent, tolerance of the budget
  transfer_change,     ///< set-ups of one run differ in contrast; percent, tolerance due to their errors
  noise_change,        ///< the noise of a pixel changed during the run; percent, tolerance
  correlation_change,  ///< the correlation of successive frames changed during the run; difference of correlations
  picture_residue,     ///< pictures still changed during their measurement; percent of the change
  setting_change,      ///< a setting of the camera changed during the run; no figures
  orientation,         ///< thresholds for up and down differ from those for left and right; percent, limit
  ramp_direction,      ///< S75 differs between ramps up and down; percent, limit
  contrast_lag,        ///< small triangles lag large ones in a ramp by more than stated; seconds, stated seconds
};
inline constexpr std::array all_finding_kinds{FindingKind::deviance,           FindingKind::lapse,
                                              FindingKind::overdispersion,     FindingKind::underdispersion,
                                              FindingKind::extrapolation,      FindingKind::slope,
                                              FindingKind::direct_estimate,    FindingKind::clipping,
                                              FindingKind::rounding,           FindingKind::temporal_correlation,
                                              FindingKind::identity,           FindingKind::contrast_deviation,
                                              FindingKind::transfer_change,    FindingKind::noise_change,
                                              FindingKind::correlation_change, FindingKind::picture_residue,
                                              FindingKind::setting_change,     FindingKind::surrogate,
                                              FindingKind::orientation,        FindingKind::ramp_direction,
                                              FindingKind::contrast_lag};
[[nodiscard]] std::string_view to_string(FindingKind kind);

/// One finding against a result.
struct AdequacyFinding {
  FindingKind kind = FindingKind::deviance;
  std::optional<double> value{};  ///< observed value
  std::optional<double> limit{};  ///< limit beyond which the value is a finding
  std::string sentence{};         ///< sentence for reports, without a full stop
  bool unfit = false;             ///< the result must not be used for a decision
  bool operator==(const AdequacyFinding&) const = default;
};

/// All findings against a result.
struct Adequacy {
  std::vector<AdequacyFinding> findings{};
  /// Returns whether the result is fit for a decision: no finding is `unfit`.
  [[nodiscard]] bool adequate() const {
    return std::none_of(findings.begin(), findings.end(), [](const AdequacyFinding& finding) { return finding.unfit; });
  }
  bool operator==(const Adequacy&) const = default;
};

/// Returns the sentences of the findings that make a result unfit, joined by "; "; empty if there are none.
[[nodiscard]] std::string reasons_unfit(const Adequacy& adequacy);

}  // namespace todbench
