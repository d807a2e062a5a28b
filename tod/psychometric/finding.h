// What speaks against a number: findings with their figures, as values.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace todbench {

/// What a finding is about, with the meaning of its value and limit.
enum class FindingKind {
  deviance,         ///< shape of the answers against the model; standard deviations (of the direction in the words)
  lapse,            ///< a free lapse explains the answers better; 2 ln likelihood ratio, corrected for clusters
  overdispersion,   ///< answers scatter more than chance; ratio of variances
  underdispersion,  ///< answers scatter less than chance; ratio of variances
  extrapolation,    ///< threshold outside the tested sizes; size, nearest tested size
  slope,            ///< slope at an end of its domain; slope, that end
  direct_estimate,  ///< fit against the estimate without trials; difference in percent, what both allow
  clipping,         ///< saturated pixels in windows of triangles; share of trials
  rounding,         ///< a count is wider than the noise; standard deviation of the noise in counts
  temporal_correlation,  ///< successive frames share noise; correlation
  identity,  ///< of two curves: on other plates, of the same answers, or fitted with other functions; no figures
};
inline constexpr std::array all_finding_kinds{FindingKind::deviance,        FindingKind::lapse,
                                              FindingKind::overdispersion,  FindingKind::underdispersion,
                                              FindingKind::extrapolation,   FindingKind::slope,
                                              FindingKind::direct_estimate, FindingKind::clipping,
                                              FindingKind::rounding,        FindingKind::temporal_correlation,
                                              FindingKind::identity};
[[nodiscard]] std::string_view to_string(FindingKind kind);

/// One thing that speaks against a number.
struct AdequacyFinding {
  FindingKind kind = FindingKind::deviance;
  std::optional<double> value{};  ///< what was found
  std::optional<double> limit{};  ///< beyond which it is a finding
  std::string sentence{};         ///< without a full stop
  bool unfit = false;             ///< the number may not be used for a decision
  bool operator==(const AdequacyFinding&) const = default;
};

/// All that speaks against a number.
struct Adequacy {
  std::vector<AdequacyFinding> findings{};
  /// Fit for a decision: no finding says otherwise.
  [[nodiscard]] bool adequate() const {
    return std::none_of(findings.begin(), findings.end(), [](const AdequacyFinding& finding) { return finding.unfit; });
  }
  bool operator==(const Adequacy&) const = default;
};

/// The sentences of the findings that make a number unfit, joined by "; "; empty where there are none.
[[nodiscard]] std::string reasons_unfit(const Adequacy& adequacy);

}  // namespace todbench
