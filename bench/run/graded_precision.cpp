#include "bench/run/graded_precision.h"

#include <algorithm>
#include <boost/math/special_functions/owens_t.hpp>
#include <cmath>

#include "acquisition/core/distributions.h"

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
  const double z = distribution::quantile(distribution::Normal(), seen);
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

int cheapest_frames(GradedDesignFigures design, double single_s, double frame_s) {
  std::array<double, frame_choices.size()> prices{};
  for (std::size_t i = 0; i < frame_choices.size(); ++i) {
    design.frames = frame_choices[i];
    prices[i] = graded_variance_ratio(design) * (single_s + (frame_choices[i] - 1) * frame_s);
  }
  const double most = 1.1 * *std::ranges::min_element(prices);
  const auto first = std::ranges::find_if(prices, [&](double price) { return price <= most; });
  return frame_choices[static_cast<std::size_t>(first - prices.begin())];
}

double graded_interval_factor(const GradedDesignFigures& design) {
  const double freedom = graded_freedom(design);
  const double t = distribution::quantile(distribution::StudentsT(freedom), 0.975);
  return t * std::sqrt(distribution::quantile(distribution::ChiSquared(freedom), 0.95) / freedom);
}

}  // namespace todbench
