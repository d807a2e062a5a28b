// A measured value with its uncertainty against tolerance limits: decision rules by name, and the risks they carry.
#pragma once

#include <optional>
#include <string_view>

#include "acquisition/core/result.h"
#include "bench/plan/conformity_rule.h"

namespace todbench {

enum class ConformityDecision { pass, conditional_pass, inconclusive, conditional_fail, fail };
/// "conditional pass"
[[nodiscard]] std::string_view to_string(ConformityDecision decision);

/// One or two limits.
struct ToleranceLimits {
  std::optional<double> at_least{}, at_most{};
};

/// Value and limits in one unit. A ratio scale, such as acuity, is judged by its logarithm.
struct MeasuredValue {
  double value = 0;
  double u = 0;                                ///< standard uncertainty
  std::optional<double> degrees_of_freedom{};  ///< of u; nothing: very many
};

struct Conformity {
  ConformityDecision decision = ConformityDecision::inconclusive;
  double guard_band = 0;  ///< 0 under the simple rule
  /// The tolerance, narrower by the guard band on each side. A value on a limit is inside.
  ToleranceLimits acceptance{};
  bool acceptance_zone_is_empty = false;  ///< nothing can pass
  /// Probability that the true value lies inside the tolerance, with little prior knowledge (JCGM 106:2012, 7): of a
  /// wrong rejection where the decision is to fail.
  double p_conformity = 0;
  double p_nonconformity = 0;  ///< the rest; of a wrong acceptance where the decision is to pass
};

/// `invalid_input`: no limit, limits in the wrong order, a number that is not finite, u or degrees of freedom not above
/// 0, a negative guard band.
[[nodiscard]] Result<Conformity> conformity(const MeasuredValue& measured, const ToleranceLimits& tolerance,
                                            ConformityRule rule, double guard_band);

/// The guard band that leaves this risk of a wrong acceptance at the acceptance limit of one tolerance limit: z(1 - r)
/// u, with t instead of z for few degrees of freedom. Precondition: 0 < risk <= 0.5, u > 0.
[[nodiscard]] double guard_band_for_risk(double risk, const MeasuredValue& measured);

/// True values over a fleet, taken as normal.
struct Fleet {
  double mean = 0, sd = 0;
};

/// Of a unit drawn from the fleet and measured with a normal error (JCGM 106:2012, 9).
struct GlobalRisks {
  double p_conforming = 0, p_accepted = 0;
  double consumer_risk = 0;                ///< accepted and outside the tolerance
  double producer_risk = 0;                ///< rejected and inside
  double p_nonconforming_if_accepted = 0;  ///< 0 where nothing is accepted
};

/// `invalid_input`: sd or u not above 0, or no limit.
[[nodiscard]] Result<GlobalRisks> global_risks(const Fleet& fleet, double u, const ToleranceLimits& tolerance,
                                               const ToleranceLimits& acceptance);

}  // namespace todbench
