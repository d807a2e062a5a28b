// SPDX-License-Identifier: GPL-3.0-or-later
// Combination of independent standard uncertainties with finite degrees of freedom.
#pragma once

#include <optional>

namespace todbench {

/// Root sum of squares of independent contributions, with the effective degrees of freedom of Welch and Satterthwaite
/// (JCGM 100:2008, G.4, equation G.2b).
class JoinedUncertainty {
 public:
  /// Adds a standard uncertainty in the unit of the result; empty degrees of freedom: infinite.
  void add(double standard, const std::optional<double>& degrees_of_freedom);
  /// Returns the combined standard uncertainty in the unit of the result.
  [[nodiscard]] double u() const { return u_; }
  /// Returns u times Student's t for this upper tail probability.
  [[nodiscard]] double half_width(double upper_tail) const;

 private:
  double u_ = 0;
  double of_few_ = 0;  ///< root of the sum of u^4 / nu
};

}  // namespace todbench
