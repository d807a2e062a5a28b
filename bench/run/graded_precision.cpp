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

/// The part that noise with this share of what decides has in the variance of an answer at the threshold.
double part_of_answers(double share) {
  constexpr double p = 0.75, seen = 2.0 / 3;  // p = 1/4 + 3/4 seen
  const double z = distribution::quantile(distribution::Normal(), seen);
  const double rho = std::clamp(share, 0.0, 1.0);
  // Phi2(z, z; rho) = Phi(z) - 2 T(z, sqrt((1 - rho) / (1 + rho))) (Owen 1956).
  const double both = seen - 2 * boost::math::owens_t(z, std::sqrt((1 - rho) / (1 + rho)));
  return 0.75 * 0.75 * (both - seen * seen) / (p * (1 - p));
}

double phases_of(const GradedDesignFigures& design) {
  return std::max(1.0, static_cast<double>(design.presentations) / design.set_ups);
}

/// Presentations of a triangle that see the same pattern, and triangles of other set-ups that do: 1 or more.
double answers_of_a_pattern(const GradedDesignFigures& design) {
  constexpr double of_other_set_ups = 1.5, moved_pitch = 1.9;
  const double alike = std::exp(-std::pow(moved_pitch / design.size_pitch, 2));
  return std::max(1.0, phases_of(design) * of_other_set_ups * alike);
}

}  // namespace

double graded_variance_ratio(const GradedDesignFigures& design) {
  const double of_sensor = part_of_answers(design.sensor_share), of_pattern = part_of_answers(design.pattern_share);
  // Evenly spread phases leave a variance that falls with their square, that of answers falls with their number.
  const double left = design.set_ups >= cancelling_set_ups ? std::min(0.15, 0.048 / phases_of(design)) : 0.15;
  const double frames = design.frames, draws = design.draws;
  return (of_sensor - of_pattern) / frames + (1 - of_sensor) / (frames * draws) + left +
         of_pattern * answers_of_a_pattern(design);
}

double pattern_inflation(const GradedDesignFigures& design) {
  return 1 + part_of_answers(design.pattern_share) * (answers_of_a_pattern(design) - 1);
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
  const double of_shared_detectors = design.set_ups >= cancelling_set_ups ? 1.06 : 1;
  return of_shared_detectors * t * std::sqrt(distribution::quantile(distribution::ChiSquared(freedom), 0.95) / freedom);
}

}  // namespace todbench
