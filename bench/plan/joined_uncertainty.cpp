// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/joined_uncertainty.h"

#include <cmath>

#include "acquisition/base/distributions.h"

namespace todbench {

void JoinedUncertainty::add(double standard, const std::optional<double>& degrees_of_freedom) {
  u_ = std::hypot(u_, standard);
  if (degrees_of_freedom) of_few_ = std::hypot(of_few_, standard * standard / std::sqrt(*degrees_of_freedom));
}

double JoinedUncertainty::half_width(double upper_tail) const {
  const double nu = of_few_ > 0 ? std::pow(u_ * u_ / of_few_, 2) : 0;
  const bool few = nu > 0 && std::isfinite(nu);
  return u_ * distribution::quantile_above(upper_tail, few ? std::optional(nu) : std::nullopt);
}

}  // namespace todbench
