#include "bench/run/graded_precision.h"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/owens_t.hpp>
#include <cmath>

namespace todbench {
namespace {

constexpr int cancelling_set_ups = 5;  // clustered_variance.h: least_set_ups

double graded_freedom(const GradedDesignFigures& design) {
  if (design.set_ups >= cancelling_set_ups) return design.set_ups - 1;
  return std::max(3.0, 0.5 * design.presentations - 1);
}

}  // namespace

double graded_variance_ratio(const GradedDesignFigures& design) {
  constexpr double p = 0.75, seen = 2.0 / 3;  // p = 1/4 + 3/4 seen
  const double z = boost::math::quantile(boost::math::normal(), seen);
  const double share = std::clamp(design.sensor_share, 0.0, 1.0);
  // Phi2(z, z; rho) = Phi(z) - 2 T(z, sqrt((1 - rho) / (1 + rho))) (Owen 1956).
  const double both = seen - 2 * boost::math::owens_t(z, std::sqrt((1 - share) / (1 + share)));
  const double of_sensor = 0.75 * 0.75 * (both - seen * seen) / (p * (1 - p));
  // Evenly spread phases leave a variance that falls with their square, that of answers falls with their number.
  const double phases = std::max(1.0, static_cast<double>(design.presentations) / design.set_ups);
  const double left = design.set_ups >= cancelling_set_ups ? std::min(0.15, 0.048 / phases) : 0.15;
  const double frames = design.frames, draws = design.draws;
  return of_sensor / frames + (1 - of_sensor) / (frames * draws) + left;
}

double graded_interval_factor(const GradedDesignFigures& design) {
  const double freedom = graded_freedom(design);
  const double t = boost::math::quantile(boost::math::students_t(freedom), 0.975);
  return t * std::sqrt(boost::math::quantile(boost::math::chi_squared(freedom), 0.95) / freedom);
}

}  // namespace todbench
