// SPDX-License-Identifier: GPL-3.0-or-later
// Conformity of a measured value with tolerance limits: named decision rules and their risks.
#pragma once

#include <optional>
#include <string_view>

#include "acquisition/base/result.h"
#include "bench/plan/conformity_rule.h"

namespace todbench {

/// Result of a decision rule.
enum class ConformityDecision { pass, conditional_pass, inconclusive, conditional_fail, fail };
/// Returns the decision in words, for example "conditional pass".
[[nodiscard]] std::string_view to_string(ConformityDecision decision);

/// One or two limits.
struct ToleranceLimits {
  std::optional<double> at_least{}, at_most{};
};

/// Measured value in the unit of the limits. For ratio scales (acuity) use the logarithm.
struct MeasuredValue {
  double value = 0;
  double u = 0;                                ///< standard uncertainty
  std::optional<double> degrees_of_freedom{};  ///< degrees of freedom of u; empty: infinite
};

/// Decision with its guard band and probabilities.
struct Conformity {
  ConformityDecision decision = ConformityDecision::inconclusive;
  double guard_band = 0;  ///< 0 for the simple rule
  /// Tolerance reduced by the guard band on each side. A value on a limit is inside.
  ToleranceLimits acceptance{};
  bool acceptance_zone_is_empty = false;  ///< no value can pass
  /// Probability that the true value lies inside the tolerance, with little prior knowledge (JCGM 106:2012, 7). If the
  /// decision is a fail, this is the risk of a wrong rejection.
  double p_conformity = 0;
  double p_nonconformity = 0;  ///< 1 - p_conformity; if the decision is a pass, the risk of a wrong acceptance
};

/// Decides by `rule`. Errors: `invalid_input` (no limit, limits in the wrong order, a non-finite number, u or degrees
/// of freedom of 0 or less, negative guard band).
[[nodiscard]] Result<Conformity> conformity(const MeasuredValue& measured, const ToleranceLimits& tolerance,
                                            ConformityRule rule, double guard_band);

/// Returns the guard band with which a value at the acceptance limit has this risk of a wrong acceptance: u times the
/// (1 - risk) quantile of Student's t (infinite degrees of freedom: normal). Precondition: 0 < risk <= 0.5, u > 0.
[[nodiscard]] double guard_band_for_risk(double risk, const MeasuredValue& measured);

/// Returns the guard band 2 u; with finite degrees of freedom, the guard band with the same risk by Student's t.
[[nodiscard]] double usual_guard_band(const MeasuredValue& measured);

/// Normal distribution of true values over a fleet.
struct Fleet {
  double mean = 0, sd = 0;
};

/// Risks for a unit drawn from the fleet and measured with a normal error (JCGM 106:2012, 9). With finite degrees of
/// freedom, the error over u follows Student's t.
struct GlobalRisks {
  double p_conforming = 0, p_accepted = 0;
  double consumer_risk = 0;                ///< probability that a unit is accepted and outside the tolerance
  double producer_risk = 0;                ///< probability that a unit is rejected and inside the tolerance
  double p_nonconforming_if_accepted = 0;  ///< 0 if no unit is accepted
};

/// Measurement error of a unit of the fleet.
struct MeasurementError {
  double u = 0;                                ///< standard uncertainty
  std::optional<double> degrees_of_freedom{};  ///< degrees of freedom of u; empty: infinite
};

/// Computes the risks. Errors: `invalid_input` (sd, u or degrees of freedom of 0 or less, or no limit).
[[nodiscard]] Result<GlobalRisks> global_risks(const Fleet& fleet, const MeasurementError& error,
                                               const ToleranceLimits& tolerance, const ToleranceLimits& acceptance);

}  // namespace todbench
