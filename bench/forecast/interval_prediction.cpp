// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/forecast/interval_prediction.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>

#include "acquisition/base/distributions.h"
#include "acquisition/base/normal.h"
#include "bench/forecast/visit_order.h"
#include "bench/plan/plan_options.h"
#include "bench/twin/paired_comparison.h"
#include "bench/twin/twin_shapes.h"
#include "tod/comparison/planning.h"
#include "tod/plate/test_pattern.h"
#include "tod/psychometric/picture_places.h"

namespace todbench {
namespace {

// Weibull slopes of the searching observer: 2.8 (noise dominates) to 6.5 (microscan, no noise). The first tier finds
// them within a quarter, except without noise, where its function has steps.
constexpr double flattest = 2.5, steepest = 6;

// Intervals of runs over that of the expected counts with Student's t: 1.017 +- scatter_of_binary_error, because
// answers scatter and trials of one presentation or place are slightly dependent. 95 % of runs stay below 1.185
// (asked_uncertainty_study: 1.03 and 1.2 of the normal interval, with 96 presentations).
constexpr double likely_excess = 1.185, mean_excess = 1.017;

/// Trials per size at one contrast.
std::vector<Level> levels_of(const Plan& plan, const std::vector<TargetPlate>& plates) {
  std::map<double, double> totals;
  for (std::size_t i = 0; i < plates.size(); ++i) {
    for (const auto& t : plates[i].triangles)
      totals[t.size_mm / plan.target.distance_m] +=
          static_cast<double>(mountings_of(plan.target, i)) * plan.simulation.phases;
  }
  std::vector<Level> levels;
  for (const auto& [size, total] : totals)
    levels.push_back({.size = size, .correct = 0, .total = total, .cluster = -1});
  return levels;
}

/// Shares in the variance of the noise that decides an answer at a contrast.
struct NoiseShares {
  double sensor = 0;   ///< noise of the sensor, not of the observer
  double pattern = 0;  ///< its fixed pattern, which q_eff does not include
};

NoiseShares noise_shares(const ExperimentInputs& inputs, const ContrastOutlook& outlook) {
  const TemplateObserverSpec& observer = inputs.observer;
  const double white = outlook.q_eff * outlook.q_eff, own = outlook.observer_variance;
  const double factor = observer.sensor_noise_factor * observer.sensor_noise_factor;
  const double pattern =
      std::pow(inputs.sensor.samples_per_pitch() * inputs.sensor.fixed_pattern_k / outlook.delta_t_k, 2);
  const double all = white + pattern;
  return {(std::max(0.0, white - own) / factor + pattern) / all, pattern / all};
}

/// Relative standard error of the threshold of a table of proportions (needed_draws(), twin_shapes.h), for answers with
/// this standard error.
double se_of_shape(const Accuracy& accuracy, double q_eff, std::optional<double> se_ln_threshold) {
  return (0.046 + 0.285 * q_eff) / std::sqrt(draws_of_twin_shape(se_ln_threshold, accuracy));
}

/// Information about the threshold of a trial of this size, in any unit.
double information(double size, double threshold, double slope, double lapse, PsychometricForm form) {
  const Level level{.size = size, .correct = 0, .total = 1, .cluster = -1};
  const auto at = [&](double stretched) {
    return design_at({&level, 1}, form, stretched, slope, lapse).front().proportion_correct;
  };
  constexpr double step = 1e-3;
  const double p = at(threshold), change = at(threshold * (1 + step)) - p;
  return p > 0 && p < 1 ? change * change / (p * (1 - p)) : 0;
}

double total(const std::vector<double>& numbers) {
  return std::accumulate(numbers.begin(), numbers.end(), 0.0);
}

/// Number of clusters by their shares of the information, (sum)^2 / sum of squares; 0 without information.
double effective_number(const std::vector<double>& information) {
  const double squares = std::inner_product(information.begin(), information.end(), information.begin(), 0.0);
  return squares > 0 ? std::pow(total(information), 2) / squares : 0;
}

/// Information of a presentation of each triangle of a plate.
std::vector<double> triangle_information(const Plan& plan, const ExperimentInputs& inputs,
                                         const ContrastOutlook& outlook, const TargetPlate& plate) {
  const double s75_mrad = outlook.s75_pitch * inputs.sensor.ifov_mrad();
  const double slope = std::clamp(outlook.weibull_slope, flattest, steepest);
  std::vector<double> out;
  for (const PlateTriangle& t : plate.triangles)
    out.push_back(
        information(t.size_mm / plan.target.distance_m, s75_mrad, slope, plan.fit.lapse.value_or(0.01), plan.fit.form));
  return out;
}

/// Triangles of all set-ups with their places in the picture.
std::vector<PlacedInformation> placed_information(const Plan& plan, const ExperimentInputs& inputs,
                                                  const ContrastOutlook& outlook) {
  std::vector<std::vector<double>> of_plates;
  for (const TargetPlate& plate : inputs.plates)
    of_plates.push_back(triangle_information(plan, inputs, outlook, plate));
  const double pixels_per_mm = 1 / (plan.target.distance_m * inputs.sensor.ifov_mrad());
  std::vector<Trial> triangles;
  std::vector<PlacedInformation> out;
  const std::vector<NumberedSetUp> set_ups = numbered_set_ups(plan, inputs.plates.size());
  for (std::size_t i = 0; i < set_ups.size(); ++i) {
    const TargetPlate& plate = inputs.plates[set_ups[i].plate];
    const Mounting mounting = plan.target.mountings[set_ups[i].mounting];
    const std::vector<PlateTriangle> shown = mounted(plate, mounting).triangles;  // in the order of the plate
    for (std::size_t k = 0; k < shown.size(); ++k) {
      const PlateTriangle& t = shown[k];
      Trial& trial = triangles.emplace_back();
      trial.plate = plate.name, trial.mounting = mounting, trial.triangle = t.name;
      trial.size_px = t.size_mm * pixels_per_mm;
      trial.centroid = PlaceInPicture{t.position_mm.x * pixels_per_mm, t.position_mm.y * pixels_per_mm};
      out.push_back({.set_up = i, .information = of_plates[set_ups[i].plate][k]});
    }
  }
  const std::vector<int> places = picture_places(triangles);
  for (std::size_t i = 0; i < out.size(); ++i) out[i].place = static_cast<std::size_t>(places[i]);
  return out;
}

/// Effective number of places after `shown` presentations of each set-up; for binary answers of triangles of set-ups.
double effective_places(const std::vector<PlacedInformation>& triangles, std::span<const int> shown,
                        AnswerKind answers) {
  std::vector<double> of_places(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const PlacedInformation& one = triangles[i];
    of_places[answers == AnswerKind::binary ? i : one.place] += one.information * shown[one.set_up];
  }
  return effective_number(of_places);
}

/// Sets the interval of ln S75 of graded answers of a design, from the standard error of as many binary ones.
void predict_graded(ContrastPrediction& point, const Plan& plan, const ExperimentInputs& inputs,
                    const GradedDesignFigures& design, double q_eff, double binary_se) {
  const double se = std::hypot(binary_se * std::sqrt(graded_variance_ratio(design)),
                               se_of_shape(inputs.accuracy, q_eff, std::nullopt));
  const double factor = graded_interval_factor(design);
  point.uncertainty_percent = 100 * std::expm1(factor * se);
  point.se_ln_s75 = se;
  point.degrees_of_freedom = graded_freedom(design);
  point.over_set_ups = set_ups_are_clusters(design);
  point.interval_factor = factor / graded_likely_excess(design);
  if (!pairs_asked(plan, inputs.sensor)) return;
  point.paired_se_ln_ratio =
      factor / normal_z95 * binary_se * std::sqrt(paired_variance_ratio(design, PairedTwinOptions::default_draws));
}

/// The same for binary answers.
void predict_binary(ContrastPrediction& point, const Plan& plan, const ExperimentInputs& inputs,
                    const GradedDesignFigures& design, double q_eff, double binary_se) {
  const bool by_twin = chosen_estimator(plan, inputs.sensor).estimator == FitEstimator::twin_shape;
  const double of_shape = by_twin ? se_of_shape(inputs.accuracy, q_eff, binary_se) : 0;
  const double se = std::hypot(binary_se * std::sqrt(pattern_inflation(design)), of_shape);
  const double t = distribution::quantile_above(0.025, two_way_freedom(design));
  point.uncertainty_percent = 100 * std::expm1(likely_excess * t * se);
  point.se_ln_s75 = se;
  point.interval_factor = mean_excess * t;
}

/// Standard error of ln S75 of binary answers of constant stimuli; empty if the sizes do not identify a threshold.
std::optional<double> binary_error(const Plan& plan, const ExperimentInputs& inputs, const ContrastOutlook& outlook) {
  const double s75_mrad = outlook.s75_pitch * inputs.sensor.ifov_mrad();
  const auto design = design_at(levels_of(plan, inputs.plates), plan.fit.form, s75_mrad,
                                std::clamp(outlook.weibull_slope, flattest, steepest), plan.fit.lapse.value_or(0.01));
  const auto fit = expected_fit(design, fit_options(plan));
  return fit ? std::optional(fit->se_ln_threshold) : std::nullopt;
}

}  // namespace

std::vector<double> set_up_information(const Plan& plan, const ExperimentInputs& inputs,
                                       const ContrastOutlook& outlook) {
  std::vector<double> out;
  for (std::size_t i = 0; i < inputs.plates.size(); ++i)
    out.insert(out.end(), static_cast<std::size_t>(mountings_of(plan.target, i)),
               total(triangle_information(plan, inputs, outlook, inputs.plates[i])));
  return out;
}

GradedDesignFigures graded_design(const Plan& plan, const ExperimentInputs& inputs, const ContrastOutlook& outlook,
                                  const std::vector<double>& information) {
  const NoiseShares shares = noise_shares(inputs, outlook);
  const auto set_ups = static_cast<int>(set_ups_of(plan.target));
  // A simulated scene changes between two frames.
  const double change_s = plan.target.kind == TargetKind::scene ? 0 : plan.target.shift_change_s;
  return {.sensor_share = shares.sensor,
          .pattern_share = shares.pattern,
          .noise = outlook.q_eff,
          .size_pitch = outlook.s75_pitch,
          .frames = chosen_answers(plan, inputs.sensor, outlook.delta_t_k).frames,
          .draws = MeasurementOptions::graded_draws,
          .set_ups = set_ups,
          .informative_set_ups = effective_number(information),
          .presentations = set_ups * plan.simulation.phases,
          .noise_correlation = inputs.sensor.noise_correlation,
          .frames_between = change_s * inputs.sensor.frame_rate_hz};
}

std::optional<AnswerForecast> answer_forecast(const Plan& plan, const ExperimentInputs& inputs, double delta_t_k) {
  const auto outlook = std::ranges::find(inputs.outlooks, delta_t_k, &ContrastOutlook::delta_t_k);
  if (outlook == inputs.outlooks.end()) return std::nullopt;
  const auto binary_se = binary_error(plan, inputs, *outlook);
  if (!binary_se) return std::nullopt;
  AnswerForecast forecast{.outlook = *outlook, .information = set_up_information(plan, inputs, *outlook)};
  forecast.all = graded_design(plan, inputs, *outlook, forecast.information);
  forecast.binary_se = *binary_se;
  forecast.triangles = placed_information(plan, inputs, *outlook);
  return forecast;
}

void predict_interval(ContrastPrediction& point, const Plan& plan, const ExperimentInputs& inputs,
                      const AnswerForecast& forecast, std::span<const int> shown) {
  std::vector<double> seen = forecast.information, of_presentations;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    of_presentations.insert(of_presentations.end(), static_cast<std::size_t>(shown[i]), seen[i]);
    seen[i] *= shown[i];
  }
  GradedDesignFigures design = forecast.all;
  design.informative_set_ups = effective_number(seen);
  design.informative_presentations = effective_number(of_presentations);
  const AnswerKind answers = chosen_answers(plan, inputs.sensor).kind;
  design.informative_places = effective_places(forecast.triangles, shown, answers);
  design.set_ups = static_cast<int>(std::ranges::count_if(shown, [](int n) { return n > 0; }));
  design.presentations = std::accumulate(shown.begin(), shown.end(), 0);
  const double share = total(seen) / (total(forecast.information) * plan.simulation.phases);
  const double binary_se = forecast.binary_se / std::sqrt(share);
  const auto predict = answers == AnswerKind::graded ? predict_graded : predict_binary;
  predict(point, plan, inputs, design, forecast.outlook.q_eff, binary_se);
}

}  // namespace todbench
