// SPDX-License-Identifier: GPL-3.0-or-later
// Trials and curves made of awkward numbers, for round trips.
#pragma once

#include <string>
#include <tuple>
#include <vector>

#include "acquisition/base/rng.h"
#include "tod/presentation/presentation.h"
#include "tod/presentation/trial.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench::testing {

/// Everything in a trial, comparable.
inline auto values_of(const Trial& t) {
  return std::make_tuple(t.presentation, t.plate, t.mounting, t.triangle, t.set_delta_t_k, t.delta_t_k, t.size_mm,
                         t.size_mrad, t.size_px, t.truth, t.answer, t.scores, t.phase_x_px, t.phase_y_px, t.frame,
                         t.device_time_ns, t.host_time_ns, t.since_nuc_s, t.saturated_pixels, t.probability_correct,
                         t.frames, t.centroid ? t.centroid->x_px : -1, t.centroid ? t.centroid->y_px : -1);
}

/// A presentation in which nothing is missing and no two numbers are the same.
inline Presentation full_presentation() {
  return {
      .presentation = 3,
      .set = {.plate = "plate, \"1\"", .mounting = Mounting::rotated_180, .delta_t_k = -1.93, .shift_mm = {0.1, -0.2}},
      .said = {.state = {.plate = "plate, \"1\"",
                         .mounting = Mounting::rotated_180,
                         .delta_t_k = -1.9 - 1.0 / 3,
                         .shift_mm = {0.1001, -0.2003}},
               .plate_temperature_k = 295.04,
               .black_body_temperature_k = 293.11,
               .settling_s = 1.0 / 7},
      .delta_t_k = -1.9,
      .host_time_ns = 123456789012345};
}

/// Trials with numbers of full precision, names with commas and quotes, and the largest counters.
inline std::vector<Trial> random_trials(int count) {
  const RandomStream stream(11, "trial values");
  std::vector<Trial> trials;
  std::uint64_t draw = 0;
  const auto number = [&] { return 40 * stream.uniform(draw++) - 20; };
  for (int i = 0; i < count; ++i) {
    Trial t;
    t.presentation = i / 4;
    t.plate = "plate " + std::to_string(i % 2);
    t.mounting = all_mountings[static_cast<std::size_t>(i) % all_mountings.size()];
    t.triangle = "row 1, triangle \"" + std::to_string(i) + "\"";
    t.set_delta_t_k = number();
    t.delta_t_k = number();
    t.size_mm = number() + 21;
    t.size_mrad = t.size_mm / 3;
    t.size_px = t.size_mm / 7;
    t.truth = all_apexes[stream.below(4, draw++)];
    t.answer = all_apexes[stream.below(4, draw++)];
    for (double& score : t.scores) score = number() * 1e-9;
    t.phase_x_px = stream.uniform(draw++) - 0.5;
    t.phase_y_px = stream.uniform(draw++) - 0.5;
    t.frame = ~std::uint64_t{0} - static_cast<std::uint64_t>(i);
    t.device_time_ns = -i;
    t.host_time_ns = 9223372036854775807 - i;
    t.since_nuc_s = i % 3 == 0 ? -1 : stream.uniform(draw++);
    t.saturated_pixels = i % 4 == 0 ? 0 : 100 * i;
    if (i % 5 != 0) t.probability_correct = i % 5 == 1 ? 1 : stream.uniform(draw++);
    t.frames = 1 + i % 3;
    if (i % 4 != 1) t.centroid = PlaceInPicture{300 * stream.uniform(draw++), number()};
    trials.push_back(std::move(t));
  }
  return trials;
}

/// A fit with every field set, around a threshold in mrad.
inline PsychometricFit full_fit(double threshold_mrad) {
  PsychometricFit fit;
  fit.verdict = FitVerdict::ok;
  fit.threshold = threshold_mrad;
  fit.ci95 = {threshold_mrad * 0.95, threshold_mrad / 0.95};
  fit.ci90 = {threshold_mrad * 0.96, threshold_mrad / 0.96};
  fit.slope = 10.0 / 3;
  fit.lapse = 0.01;
  fit.log_likelihood = -100.0 / 7;
  fit.deviance = 5.5;
  fit.degrees_of_freedom = 8;
  fit.se_ln_threshold = 0.02;
  fit.posterior = Posterior{threshold_mrad * 1.001, threshold_mrad * 0.94, threshold_mrad * 1.07, true};
  fit.trials = 640;
  fit.clusters = 32;
  fit.variance_inflation = 1.25;
  fit.interval = IntervalKind::set_ups;
  fit.dispersion = 0.375;
  fit.twin_shape = TwinShapeUse{.size_ratio = 1.0 / 0.97,
                                .slope_ratio = 0.9,
                                .slope_fitted = true,
                                .departure = -1.25,
                                .departure_limit = 2.75,
                                .departure_shift = -0.001,
                                .shape_se_ln_threshold = 1e-3,
                                .lapse_inflation = 1.5,
                                .table = {{1, 2, 4}, {0.3, 0.7, 1}, {0.01, 0.02, 0}}};
  return fit;
}

inline TodPoint full_point(double delta_t_k, double threshold_mrad) {
  TodPoint point;
  point.set_delta_t_k = delta_t_k;
  point.delta_t_k = delta_t_k * 0.97;
  point.delta_t_se_k = 0.003;
  point.levels = {{threshold_mrad / 2, 10, 40, 3}, {threshold_mrad * 2, 40, 40, -1}};
  point.fit = full_fit(threshold_mrad);
  point.free_lapse_fit = full_fit(threshold_mrad * 1.01);
  point.lapse_warning = true;
  point.estimator_reason = EstimatorReason::twin;
  point.answers = AnswersTaken{AnswerKind::graded, 4, AnswersReason::plan};
  point.direct_s75_mrad = threshold_mrad * 1.002;
  point.direct_s75_se_mrad = 0.004;
  point.saturated_share = 0.0625;
  point.noise_counts = 7.25;
  point.lag1_correlation = -0.125;
  return point;
}

inline TodCurve full_curve() {
  return {"hvs-1", "sc2000", {full_point(16.9, 2.084), full_point(1.93, 2.2), full_point(0.23, 3.447)}};
}

}  // namespace todbench::testing
