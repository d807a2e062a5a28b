// SPDX-License-Identifier: GPL-3.0-or-later
// Virtual laboratories over the wire beside those of the same numbers on simulated frames.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "tests/bench/studies/virtual_laboratories.h"
#include "tests/bench/studies/wire_laboratory.h"

namespace todbench::testing {

/// A busy machine loses frames of a camera that does not wait, and the others say the same.
inline Plan plan_of_wire_laboratories(const GradedDesign& design, std::uint64_t seed) {
  Plan plan = plan_of_laboratories(design, seed);
  plan.measurement.frame_timeout_ms = 20000;
  plan.measurement.max_rejected_share = 0.9;
  return plan;
}

/// Two ways to measure a laboratory with the same errors: what chance alone makes of ln S75.
struct WireDifference {
  double in_u = 0;                  ///< over the wire less simulated, in combined standard uncertainties of the trials
  std::optional<double> freedom{};  ///< degrees of freedom of those (Welch-Satterthwaite); nothing: very many
  double percent = 0, u_percent = 0;  ///< the difference and that uncertainty
};

inline WireDifference difference_of(const LaboratoryPoint& wire, const LaboratoryPoint& simulated) {
  const double u = std::hypot(wire.u_trials, simulated.u_trials),
               difference = std::log(wire.s75_mrad / simulated.s75_mrad);
  double fourths = 0;
  for (const LaboratoryPoint* one : {&wire, &simulated})
    fourths += std::pow(one->u_trials / u, 4) / one->trials_freedom.value_or(std::numeric_limits<double>::infinity());
  return {.in_u = difference / u,
          .freedom = fourths > 0 ? std::optional(1 / fourths) : std::nullopt,
          .percent = 100 * difference,
          .u_percent = 100 * u};
}

/// Of the laboratories that both have, in the order of their numbers.
inline std::vector<WireDifference> differences_of(const std::vector<LaboratoryPoint>& wire,
                                                  const std::vector<LaboratoryPoint>& simulated) {
  std::vector<WireDifference> out;
  for (const LaboratoryPoint& one : wire) {
    const auto same = std::find_if(simulated.begin(), simulated.end(), [&](const LaboratoryPoint& other) {
      return other.laboratory == one.laboratory && other.delta_t_k == one.delta_t_k;
    });
    if (same != simulated.end()) out.push_back(difference_of(one, *same));
  }
  return out;
}

/// What the differences at one contrast say.
struct DifferenceSummary {
  int laboratories = 0;
  double mean = 0, rms = 0, beyond_two = 0;  ///< in combined standard uncertainties; share
  double mean_percent = 0, u_percent = 0;    ///< of ln S75; mean uncertainty
  /// Largest rms and mean that chance makes: three standard errors above what Student's t has in the mean of squares,
  /// and of a mean.
  double largest_rms = 0, largest_mean = 0;
};

inline DifferenceSummary summary_of(const std::vector<WireDifference>& differences) {
  DifferenceSummary out{.laboratories = static_cast<int>(differences.size())};
  const double n = out.laboratories;
  double squares = 0, expected = 0, variance = 0;
  for (const WireDifference& d : differences) {
    out.mean += d.in_u / n;
    out.mean_percent += d.percent / n;
    out.u_percent += d.u_percent / n;
    squares += d.in_u * d.in_u / n;
    out.beyond_two += (std::abs(d.in_u) > 2 ? 1 : 0) / n;
    // t^2 has the law F(1, nu); its variance needs more than four degrees of freedom.
    const double nu = std::max(5.0, d.freedom.value_or(1e9));
    expected += nu / (nu - 2) / n;
    variance += 2 * nu * nu * (nu - 1) / ((nu - 2) * (nu - 2) * (nu - 4)) / (n * n);
  }
  out.rms = std::sqrt(squares);
  out.largest_rms = std::sqrt(expected + 3 * std::sqrt(variance));
  out.largest_mean = 3 * std::sqrt(expected / n);
  return out;
}

}  // namespace todbench::testing
