// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/forecast/graded_precision.h"

#include <algorithm>
#include <boost/math/special_functions/owens_t.hpp>
#include <cmath>

#include "acquisition/base/distributions.h"
#include "tod/psychometric/clustered_variance.h"

namespace todbench {
namespace {

/// Share of the variance of an answer at the threshold due to noise with this share of the deciding noise.
double part_of_answers(double share) {
  constexpr double p = 0.75, seen = 2.0 / 3;  // p = 1/4 + 3/4 seen
  const double z = distribution::quantile(distribution::Normal(), seen);
  const double rho = std::clamp(share, 0.0, 1.0);
  // Phi2(z, z; rho) = Phi(z) - 2 T(z, sqrt((1 - rho) / (1 + rho))) (Owen 1956).
  const double both = seen - 2 * boost::math::owens_t(z, std::sqrt((1 - rho) / (1 + rho)));
  return 0.75 * 0.75 * (both - seen * seen) / (p * (1 - p));
}

/// Share of the variance of answers that the phases leave.
double left_of_phases(const GradedDesignFigures& design, double phases) {
  // The variance left by evenly spread phases falls with the square of their number, that of answers with their number.
  return set_ups_are_clusters(design) ? std::min(0.15, 0.048 / phases) : 0.28 / (1 + std::pow(design.noise / 0.13, 2));
}

double phases_of(const GradedDesignFigures& design) {
  return std::max(1.0, static_cast<double>(design.presentations) / design.set_ups);
}

/// Share of common detectors after a sub-pixel shift of the triangle.
double same_detectors(const GradedDesignFigures& design) {
  constexpr double moved_pitch = 1.9;
  return std::exp(-std::pow(moved_pitch / design.size_pitch, 2));
}

/// Number of presentations of a triangle with the same pattern, including triangles of other set-ups; at least 1.
double answers_of_a_pattern(const GradedDesignFigures& design) {
  constexpr double of_other_set_ups = 1.5;
  return std::max(1.0, phases_of(design) * of_other_set_ups * same_detectors(design));
}

/// Covariance of the answers to two frames at this lag, without that of the pattern, over the variance of an answer.
double shared_at(const GradedDesignFigures& design, double lag_frames) {
  const double remembered = (design.sensor_share - design.pattern_share) *
                            std::pow(std::clamp(design.noise_correlation, 0.0, 1.0), lag_frames);
  return part_of_answers(design.pattern_share + remembered) - part_of_answers(design.pattern_share);
}

/// Variance of the mean of the answers to the frames of a presentation, due to the sensor's temporal noise.
double of_own_frames(const GradedDesignFigures& design) {
  double sum = shared_at(design, 0);
  if (design.noise_correlation > 0) {
    for (int k = 1; k < design.frames; ++k)
      sum += 2 * (1 - static_cast<double>(k) / design.frames) * shared_at(design, k);
  }
  return sum / design.frames;
}

/// The same for the covariance with the other, successive presentations of its set-up.
double of_other_presentations(const GradedDesignFigures& design) {
  if (!(design.noise_correlation > 0)) return 0;
  const double phases = phases_of(design), apart = design.frames + design.frames_between;
  double sum = 0;
  for (int m = 1; m < phases; ++m) {
    if (std::pow(design.noise_correlation, m * apart - design.frames) < 1e-4) break;
    double mean = 0;
    for (int k = 1 - design.frames; k < design.frames; ++k)
      mean += (design.frames - std::abs(k)) * shared_at(design, m * apart + k);
    sum += 2 * (1 - m / phases) * mean / (static_cast<double>(design.frames) * design.frames);
  }
  return sum * same_detectors(design);
}

}  // namespace

double graded_variance_ratio(const GradedDesignFigures& design) {
  const double of_sensor = part_of_answers(design.sensor_share), of_pattern = part_of_answers(design.pattern_share);
  const double left = left_of_phases(design, phases_of(design));
  const double frames = design.frames, draws = design.draws;
  return of_own_frames(design) + (1 - of_sensor) / (frames * draws) + left + of_pattern * answers_of_a_pattern(design) +
         of_other_presentations(design);
}

double paired_variance_ratio(const GradedDesignFigures& design, int twin_draws) {
  const double of_sensor = part_of_answers(design.sensor_share), of_pattern = part_of_answers(design.pattern_share);
  const double frames = design.frames, draws = design.draws;
  const double camera = of_own_frames(design) + (1 - of_sensor) / (frames * draws) +
                        of_pattern * answers_of_a_pattern(design) + of_other_presentations(design);
  return camera + (of_sensor + (1 - of_sensor) / draws) / twin_draws;
}

double pattern_inflation(const GradedDesignFigures& design) {
  GradedDesignFigures single = design;
  single.frames = 1;
  return 1 + part_of_answers(design.pattern_share) * (answers_of_a_pattern(design) - 1) +
         of_other_presentations(single);
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

bool set_ups_are_clusters(const GradedDesignFigures& design) {
  const double set_ups = design.informative_set_ups > 0 ? design.informative_set_ups : design.set_ups;
  return set_ups >= least_set_ups;
}

double two_way_freedom(const GradedDesignFigures& design) {
  double clusters = design.informative_presentations > 0 ? design.informative_presentations : design.presentations;
  if (design.informative_places > 0) clusters = std::min(clusters, design.informative_places);
  return std::max(1.0, clusters - 1);
}

double graded_freedom(const GradedDesignFigures& design) {
  return set_ups_are_clusters(design) ? design.set_ups - 1 : two_way_freedom(design);
}

double likely_excess_of_error(double degrees_of_freedom) {
  return std::sqrt(distribution::quantile(distribution::ChiSquared(degrees_of_freedom), 0.95) / degrees_of_freedom);
}

double graded_likely_excess(const GradedDesignFigures& design) {
  return likely_excess_of_error(set_ups_are_clusters(design) ? design.set_ups - 1
                                                             : std::max(3.0, 0.7 * design.presentations - 0.5));
}

double graded_interval_factor(const GradedDesignFigures& design) {
  const double t = distribution::quantile(distribution::StudentsT(graded_freedom(design)), 0.975);
  const double of_shared_detectors = set_ups_are_clusters(design) ? 1.06 : 1;
  return of_shared_detectors * t * graded_likely_excess(design);
}

}  // namespace todbench
