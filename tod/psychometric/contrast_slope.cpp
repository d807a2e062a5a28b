// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/psychometric/contrast_slope.h"

#include <algorithm>
#include <cmath>

#include "acquisition/base/distributions.h"
#include "tod/psychometric/acuity.h"

namespace todbench {
namespace {

/// A point of a curve in the variables of its form: the square of the size over the inverse contrast.
struct SlopePoint {
  std::size_t index;
  double z;       ///< 1 / contrast
  double square;  ///< S75^2
};

/// d square / d z at p of the parabola through p, a and b.
double parabola_slope(const SlopePoint& p, const SlopePoint& a, const SlopePoint& b) {
  const double to_a = (a.square - p.square) / (a.z - p.z), to_b = (b.square - p.square) / (b.z - p.z);
  return (to_a * (b.z - p.z) - to_b * (a.z - p.z)) / (b.z - a.z);
}

/// d ln acuity / d ln contrast = z / (2 S^2) dS^2/dz.
double in_logarithms(const SlopePoint& p, double slope) {
  return std::abs(0.5 * p.z * slope / p.square);
}

double slope_at(const std::vector<SlopePoint>& points, std::size_t i) {
  const std::size_t last = points.size() - 1;
  if (last == 0) return 1;
  const SlopePoint& p = points[i];
  if (last == 1) {
    // Two points allow one term: the one with the larger slope, 1 / C or 1 / C^2.
    const SlopePoint& other = points[1 - i];
    const double rise = p.square - other.square;
    return std::max(in_logarithms(p, rise / (p.z - other.z)),
                    in_logarithms(p, 2 * p.z * rise / (p.z * p.z - other.z * other.z)));
  }
  if (i > 0 && i < last) return in_logarithms(p, parabola_slope(p, points[i - 1], points[i + 1]));
  return in_logarithms(p, parabola_slope(p, points[i == 0 ? 1 : last - 1], points[i == 0 ? 2 : last - 2]));
}

}  // namespace

ContrastError at_least_the_noise(ContrastError error) {
  constexpr double tail = 0.025, noise_freedom = 1000;  // that of the pixels round the triangles
  if (error.noise_k * distribution::quantile_above(tail, noise_freedom) <=
      error.standard_error_k * distribution::quantile_above(tail, error.degrees_of_freedom))
    return error;
  error.standard_error_k = error.noise_k;
  error.degrees_of_freedom = noise_freedom;
  return error;
}

void set_contrast_errors(TodCurve& curve, const std::map<double, ContrastError>& errors) {
  for (TodPoint& point : curve.points) {
    const auto error = errors.find(point.set_delta_t_k);
    if (error == errors.end()) continue;
    point.delta_t_se_k = error->second.standard_error_k;
    point.delta_t_shared_se_k = error->second.shared_k;
    point.delta_t_freedom = error->second.degrees_of_freedom;
  }
}

double contrast_seen_k(const TodPoint& point) {
  const double seen = std::abs(point.delta_t_k);
  return seen > 0 && std::isfinite(seen) ? seen : std::abs(point.set_delta_t_k);
}

std::optional<double> contrast_se_k(const TodPoint& point) {
  const bool known = point.delta_t_measurements > 1 || point.delta_t_se_k > 0;
  return known ? std::optional(point.delta_t_se_k) : std::nullopt;
}

bool has_contrast_measured_once(const TodCurve& curve) {
  return std::any_of(curve.points.begin(), curve.points.end(),
                     [](const TodPoint& point) { return point.delta_t_measurements == 1 && !contrast_se_k(point); });
}

std::optional<double> freedom_of_contrast(const TodPoint& point) {
  if (point.delta_t_freedom) return point.delta_t_freedom;
  return point.delta_t_measurements > 1 ? std::optional(point.delta_t_measurements - 1.0) : std::nullopt;
}

std::vector<double> contrast_slopes(const TodCurve& curve) {
  std::vector<double> slopes(curve.points.size(), 1.0);
  for (const bool positive : {false, true}) {
    std::vector<SlopePoint> points;
    for (std::size_t i = 0; i < curve.points.size(); ++i) {
      const TodPoint& point = curve.points[i];
      const auto threshold = stated_threshold(point.fit);
      if ((point.set_delta_t_k > 0) != positive || !threshold || !(*threshold > 0)) continue;
      if (!(contrast_seen_k(point) > 0)) continue;
      points.push_back({i, 1 / contrast_seen_k(point), *threshold * *threshold});
    }
    std::sort(points.begin(), points.end(), [](const SlopePoint& a, const SlopePoint& b) { return a.z < b.z; });
    // Points with equal effective contrasts have no slope between them.
    points.erase(std::unique(points.begin(), points.end(),
                             [](const SlopePoint& a, const SlopePoint& b) { return std::log(b.z / a.z) < 0.005; }),
                 points.end());
    for (std::size_t i = 0; i < points.size(); ++i) slopes[points[i].index] = slope_at(points, i);
  }
  return slopes;
}

std::vector<double> contrast_effects(const TodCurve& curve) {
  std::vector<double> effects = contrast_slopes(curve);
  for (double& effect : effects)
    effect = std::isfinite(effect) ? std::max(measured_contrast_slope, effect) : measured_contrast_slope;
  return effects;
}

std::vector<ContrastScatter> contrast_scatter(const TodCurve& curve) {
  const std::vector<double> effects = contrast_effects(curve);
  std::vector<ContrastScatter> scatter;
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const TodPoint& point = curve.points[i];
    const double relative = point.delta_t_se_k / contrast_seen_k(point);
    const double shared = point.delta_t_shared_se_k / contrast_seen_k(point);
    scatter.push_back({.se_ln_acuity = std::isfinite(relative) ? effects[i] * relative : 0,
                       .shared_se_ln_acuity = std::isfinite(shared) ? effects[i] * shared : 0,
                       .degrees_of_freedom = freedom_of_contrast(point)});
  }
  return scatter;
}

void join_uncertainty(PsychometricFit& fit, double u, std::optional<double> degrees_of_freedom) {
  if (!(u > 0) || !fit.threshold || !(*fit.threshold > 0)) return;
  const auto widened = [&](Interval& interval, double tail) {
    const double half = u * distribution::quantile_above(tail, degrees_of_freedom);
    for (std::optional<double>* side : {&interval.low, &interval.high}) {
      if (!*side || !(**side > 0)) continue;
      const double own = std::log(**side / *fit.threshold);
      *side = *fit.threshold * std::exp(std::copysign(std::hypot(own, half), own));
    }
  };
  widened(fit.ci95, 0.025);
  widened(fit.ci90, 0.05);
  fit.joined_u = std::hypot(fit.joined_u, u);
}

void join_contrast_errors(TodCurve& curve) {
  const std::vector<double> effects = contrast_effects(curve);
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    TodPoint& point = curve.points[i];
    const auto se = contrast_se_k(point);
    const double seen = contrast_seen_k(point);
    if (!se || !(seen > 0)) continue;
    point.fit.contrast_u = effects[i] * *se / seen;
    join_uncertainty(point.fit, point.fit.contrast_u, freedom_of_contrast(point));
  }
}

}  // namespace todbench
