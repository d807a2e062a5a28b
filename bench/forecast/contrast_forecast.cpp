// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/forecast/contrast_forecast.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "acquisition/base/distributions.h"
#include "acquisition/base/try.h"
#include "bench/forecast/graded_precision.h"
#include "bench/forecast/limit_forecast.h"
#include "bench/forecast/visit_order.h"
#include "bench/plan/plan_options.h"
#include "tod/measurement/contrast_error.h"
#include "tod/plate/test_pattern.h"
#include "tod/psychometric/contrast_slope.h"
#include "tod/registration/registration.h"

namespace todbench {
namespace {

/// Size of the part of a reference triangle that effective_contrast() takes, over the triangle's own.
double inner_part(double size_px) {
  const double radius_px = triangle_centroid_to_base * size_px;
  return 1 - std::min(contrast_inner_share * radius_px, contrast_inner_most_px) / radius_px;
}

/// Variance of a frame's contrast due to noise of this standard deviation per pixel, row and column.
struct PixelNoise {
  double pixel_k = 0, row_k = 0, column_k = 0;
};

/// Variance of the contrast of one triangle in one frame.
double triangle_variance(double size_px, const PixelNoise& noise) {
  constexpr double of_median = std::numbers::pi / 2;
  const double inner_px = inner_part(size_px) * size_px, height = 3 * triangle_centroid_to_base;
  const double perimeter = 6 / height;  // an equilateral triangle of unit area has the height h, the side 2 / h
  const double inside = std::max(1.0, inner_px * inner_px), ring = contrast_ring_width_px * perimeter * size_px;
  return of_median * std::pow(noise.pixel_k, 2) * (1 / inside + 1 / ring) +
         std::pow(noise.row_k, 2) / std::max(1.0, height * inner_px) +
         std::pow(noise.column_k, 2) / std::max(1.0, 2 / height * inner_px);
}

/// Number of independent frames in a mean of successive ones.
double independent_frames(double frames, double correlation) {
  const double rho = std::clamp(correlation, 0.0, 0.99);
  return std::max(1.0, frames * (1 - rho) / (1 + rho));
}

/// Standard error of a contrast over its set-ups. Its estimate has the degrees of freedom of the places of the large
/// triangles, but scatters as that over the set-ups (contrast_error()).
struct ContrastScatterForecast {
  double standard_error_k = 0;
  double of_places = 1, of_set_ups = 1;
};

ContrastScatterForecast scatter_of(const std::vector<std::vector<TriangleNoise>>& noise,
                                   const std::vector<int>& looks) {
  double variance = 0, measured = 0, places = 0;
  for (std::size_t i = 0; i < noise.size() && i < looks.size(); ++i) {
    if (noise[i].empty() || looks[i] == 0) continue;
    const auto triangles = static_cast<double>(noise[i].size());
    for (const TriangleNoise& one : noise[i])
      variance += (one.temporal_k * one.temporal_k / looks[i] + one.fixed_k * one.fixed_k) / (triangles * triangles);
    measured += 1;
    places += triangles;
  }
  if (measured == 0) return {};
  return {std::sqrt(variance) / measured, std::max(1.0, places - 1), std::max(1.0, measured - 1)};
}

/// Adds the scatter of the contrast, `slope` times its relative standard error, to a prediction: half-widths are added
/// in quadrature (join_uncertainty()), and 19 of 20 runs stay below the factor of the effective degrees of freedom
/// (Welch 1947, Satterthwaite 1946).
void join(ContrastPrediction& point, const ContrastScatterForecast& scatter, double slope, bool once_in_a_set_up) {
  // contrast_error() states the largest of three variances: on the mean this factor (48 runs of five set-ups).
  constexpr double of_largest = 1.17;
  const double u = of_largest * slope * scatter.standard_error_k / std::abs(point.delta_t_k);
  if (!point.uncertainty_percent || !(u > 0) || !(point.se_ln_s75 > 0)) return;
  const double own = point.interval_factor * point.se_ln_s75;
  const double of_contrast = u * distribution::quantile_above(0.025, scatter.of_places);
  const double both = std::hypot(own, of_contrast), own_likely = std::log1p(*point.uncertainty_percent / 100);
  const double freedom = std::pow(both, 4) / (std::pow(own, 4) / point.degrees_of_freedom.value_or(1e6) +
                                              std::pow(of_contrast, 4) / scatter.of_set_ups);
  point.uncertainty_percent =
      point.stopped_at_percent.value_or(100 * std::expm1(std::max(both * likely_excess_of_error(freedom), own_likely)));
  point.se_ln_s75 = std::hypot(point.se_ln_s75, u);
  point.interval_factor = both / point.se_ln_s75;
  point.degrees_of_freedom = freedom;
  point.contrast_half_width = once_in_a_set_up ? of_contrast : 0;
}

}  // namespace

double contrast_variance_per_pixel(const TargetPlate& plate, double pixels_per_mm, double min_size_px) {
  double variance = 0, references = 0;
  for (const PlateTriangle& t : plate.triangles) {
    const double size_px = t.size_mm * pixels_per_mm;
    if (size_px < min_size_px) continue;
    variance += triangle_variance(size_px, {.pixel_k = 1});
    references += 1;
  }
  return references > 0 ? variance / (references * references) : 0;
}

std::vector<double> expected_contrast_effects(const std::vector<ContrastPrediction>& contrasts) {
  PlanPrediction expected;
  expected.contrasts = contrasts;
  return contrast_effects(expected_curve(expected));
}

std::vector<std::vector<TriangleNoise>> contrast_noise(const Plan& plan, const ExperimentInputs& inputs,
                                                       double delta_t_k) {
  const SensorSpec& sensor = inputs.sensor;
  const double pixels_per_mm = 1 / (plan.target.distance_m * sensor.ifov_mrad());
  const double frames =
      has_own_contrasts(plan) ? chosen_answers(plan, sensor, delta_t_k).frames : plan.measurement.contrast_frames;
  const double temporal = 1 / std::sqrt(independent_frames(frames, sensor.noise_correlation));
  const PixelNoise changing{.pixel_k = temporal * sensor.netd_k,
                            .row_k = temporal * sensor.row_noise_k,
                            .column_k = temporal * sensor.column_noise_k};
  std::vector<std::vector<TriangleNoise>> out;
  for (const NumberedSetUp& set_up : numbered_set_ups(plan, inputs.plates.size())) {
    std::vector<TriangleNoise>& triangles = out.emplace_back();
    for (const PlateTriangle& t :
         mounted(inputs.plates[set_up.plate], plan.target.mountings[set_up.mounting]).triangles) {
      const double size_px = t.size_mm * pixels_per_mm;
      if (size_px < plan.measurement.min_reference_px) continue;
      triangles.push_back({.place_px = pixels_per_mm * t.position_mm,
                           .size_px = size_px,
                           .temporal_k = std::sqrt(triangle_variance(size_px, changing)),
                           .fixed_k = std::sqrt(triangle_variance(size_px, {.pixel_k = sensor.fixed_pattern_k}))});
    }
  }
  return out;
}

double simulated_contrast_half_width(const std::vector<std::vector<TriangleNoise>>& noise,
                                     const std::vector<int>& looks, double delta_t_k, double slope,
                                     const RandomStream& run) {
  std::vector<ContrastMeasurement> measured;
  std::vector<ReferenceTriangle> places;
  const RandomStream detectors = run.sub(0);
  for (std::size_t i = 0; i < noise.size() && i < looks.size(); ++i) {
    for (int look = 0; look < looks[i] && !noise[i].empty(); ++look) {
      const RandomStream frames = run.sub(1 + i).sub(static_cast<std::uint64_t>(look));
      ContrastMeasurement& one = measured.emplace_back();
      for (const TriangleNoise& triangle : noise[i]) {
        ReferenceTriangle reference{.place_px = triangle.place_px,
                                    .size_px = triangle.size_px,
                                    .noise = std::hypot(triangle.fixed_k, triangle.temporal_k)};
        reference.value = triangle.fixed_k * detectors.normal(place_of(reference, places)) +
                          triangle.temporal_k * frames.normal(one.references.size());
        one.delta_t_k += reference.value / static_cast<double>(noise[i].size());
        one.references.push_back(reference);
      }
    }
  }
  const auto seen = contrast_error(measured);
  if (!seen) return 0;
  const ContrastError error = at_least_the_noise(*seen);
  return distribution::quantile_above(0.025, error.degrees_of_freedom) * slope * error.standard_error_k /
         std::abs(delta_t_k);
}

Result<std::optional<int>> enough_contrast_frames(Plan plan, const ExperimentInputs& inputs,
                                                  const std::function<bool(const ContrastPrediction&)>& enough) {
  constexpr int doublings = 6;
  for (int k = 0; k <= doublings; ++k, plan.measurement.contrast_frames *= 2) {
    TODBENCH_TRY(const auto prediction, predict_plan(plan, inputs));
    if (std::ranges::all_of(prediction.contrasts, enough)) return plan.measurement.contrast_frames;
  }
  return std::nullopt;
}

Result<std::optional<int>> deciding_contrast_frames(const Plan& plan, const ExperimentInputs& inputs,
                                                    const ContrastPrediction& contrast, double least_acuity_per_mrad,
                                                    double floor_ln) {
  if (!contrast.s75_mrad) return std::nullopt;
  const double margin = std::abs(std::log(*contrast.s75_mrad * least_acuity_per_mrad));
  if (margin <= floor_ln || margin > std::hypot(floor_ln, contrast.contrast_half_width)) return std::nullopt;
  const double deciding = std::sqrt(margin * margin - floor_ln * floor_ln);
  return enough_contrast_frames(plan, inputs, [&](const ContrastPrediction& one) {
    return !same_contrast(one.delta_t_k, contrast.delta_t_k) || 2 * one.contrast_half_width <= deciding;
  });
}

void join_contrast_scatter(std::vector<ContrastPrediction>& contrasts, const Plan& plan, const ExperimentInputs& inputs,
                           const std::vector<std::vector<int>>& looks) {
  const std::vector<double> slopes = expected_contrast_effects(contrasts);
  for (std::size_t i = 0; i < contrasts.size() && i < looks.size(); ++i) {
    ContrastPrediction& point = contrasts[i];
    join(point, scatter_of(contrast_noise(plan, inputs, point.delta_t_k), looks[i]), slopes[i],
         !has_own_contrasts(plan));
  }
}

}  // namespace todbench
