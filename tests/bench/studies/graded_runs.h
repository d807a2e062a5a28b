// Whole simulated runs with graded answers, and what every estimator makes of the same run.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "bench/plan/plan_options.h"
#include "bench/run/paired_comparison.h"
#include "bench/run/simulated_set_up.h"
#include "bench/run/twin_shapes.h"
#include "tod/plate/test_pattern.h"

namespace todbench::testing {

/// A camera, the twin that lends it its function, and what is shown.
struct GradedDesign {
  std::string name;
  SensorSpec camera{}, twin{};
  int phases = 12;  ///< as in the demonstration; 96 presentations of 20 triangles at each contrast
  std::vector<int> frames{4};
  int microscan = 1;
  std::vector<double> delta_t_k{16.9, 1.93, 0.23};
};

/// One contrast of one run by one estimator. Percentages are 100 ln of a ratio.
struct GradedResult {
  std::string design;
  std::uint64_t seed = 0;
  double delta_t_k = 0;
  std::string estimator;
  double s75_mrad = 0, low_mrad = 0, high_mrad = 0, se_percent = 0, clusters = 0,
         slope_fitted = 0;  ///< in a row of "paired" the twin's share of the variance
};

inline Plan plan_of(const GradedDesign& design, std::uint64_t seed) {
  Plan plan;
  plan.name = "graded";
  plan.seed = seed;
  plan.simulation.accuracy = "draft";  // of the pictures: 16 wavelengths less change nothing that is compared
  plan.target.delta_t_k = design.delta_t_k;
  plan.simulation.phases = design.phases;
  plan.simulation.microscan = design.microscan;
  plan.schedule.answers = AnswersChoice::graded;
  plan.schedule.frames_per_presentation = design.frames;
  plan.fit.estimator = EstimatorChoice::twin_shape;
  return plan;
}

inline ExperimentInputs inputs_of(const Plan& plan, const SensorSpec& sensor) {
  ExperimentInputs inputs;
  PlanParts parts = LoadedPlan::load(plan).value().parts();
  inputs.plates = parts.plates;
  inputs.observer = parts.observer;
  inputs.sensor = sensor;
  inputs.sensor.microscan = plan.simulation.microscan;
  inputs.effects = full_plan(inputs.sensor, {}, {});
  inputs.accuracy = accuracy_of(plan).value();
  return inputs;
}

/// The trials of a run, `simulate` without its session.
inline std::vector<Trial> trials_of(const Plan& plan, const ExperimentInputs& inputs) {
  auto set_up = simulated_set_up(plan, inputs, {}, {});
  if (!set_up) {
    ADD_FAILURE() << set_up.error().message;
    return {};
  }
  TemplateObserver observer(inputs.observer, triangle_alternatives());
  auto result = measure(*set_up->bench.camera, *set_up->bench.target, observer, *set_up->schedule, set_up->options,
                        *set_up->bench.host, MeasurementListener{}, {});
  if (!result || result->ended_by) ADD_FAILURE() << (result ? result->ended_by->message : result.error().message);
  return result ? result->trials : std::vector<Trial>{};
}

inline void add_results(std::vector<GradedResult>& results, const GradedDesign& design, std::uint64_t seed,
                        const std::string& estimator, const TodCurve& curve) {
  for (const TodPoint& point : curve.points) {
    const PsychometricFit& fit = point.fit;
    EXPECT_TRUE(fit.usable()) << design.name << " " << seed << " " << estimator;
    if (!fit.usable()) continue;
    results.push_back({design.name, seed, point.set_delta_t_k, estimator, *fit.threshold, *fit.ci95.low, *fit.ci95.high,
                       100 * fit.se_ln_threshold.value_or(0) * std::sqrt(fit.variance_inflation), fit.clusters,
                       fit.twin_shape && fit.twin_shape->slope_fitted ? 1.0 : 0.0});
  }
}

/// The same answers as one bit each and graded, with a Weibull function and with that of the twin.
inline std::vector<GradedResult> results_of(const GradedDesign& design, std::uint64_t seed) {
  const Plan plan = plan_of(design, seed);
  const ExperimentInputs camera = inputs_of(plan, design.camera), twin = inputs_of(plan, design.twin);
  const std::vector<Trial> graded = trials_of(plan, camera);
  std::vector<Trial> binary = graded;
  for (Trial& trial : binary) trial.probability_correct.reset();
  std::vector<GradedResult> results;
  TodCurve known;  // of the graded answers: right and wrong ones have the same functions
  for (const auto& [trials, kind] : {std::pair(&graded, "graded"), std::pair(&std::as_const(binary), "binary")}) {
    const auto curve = tod_curve(*trials, {.with_posterior = false});
    EXPECT_TRUE(curve) << design.name << " " << seed;
    if (!curve) continue;
    add_results(results, design, seed, std::string(kind) + " weibull", *curve);
    TodCurve shaped = *curve;
    std::map<double, double> shown;
    for (const TodPoint& point : shaped.points) shown[point.set_delta_t_k] = point.delta_t_k;
    const auto outcome = fit_twin_shapes(shaped, *trials, twin, {}, direct_options(shaped, twin, shown, seed, {}),
                                         known.points.empty() ? nullptr : &known);
    EXPECT_TRUE(outcome.notes.empty()) << outcome.notes.front();
    add_results(results, design, seed, std::string(kind) + " twin-shape", shaped);
    if (known.points.empty()) known = shaped;
  }
  return results;
}

/// What a plan with right and wrong answers and without `estimator` makes of the same run, one frame each, beside what
/// a Weibull function does.
inline std::vector<GradedResult> default_results_of(const GradedDesign& design, std::uint64_t seed) {
  Plan plan = plan_of(design, seed);
  plan.schedule = {};
  plan.schedule.answers = AnswersChoice::binary;
  plan.fit = {};
  const ExperimentInputs camera = inputs_of(plan, design.camera), twin = inputs_of(plan, design.twin);
  const std::vector<Trial> trials = trials_of(plan, camera);
  std::vector<GradedResult> results;
  auto curve = tod_curve(trials, {.with_posterior = false});
  EXPECT_TRUE(curve) << design.name << " " << seed;
  if (!curve) return results;
  add_results(results, design, seed, "default weibull", *curve);
  std::map<double, double> shown;
  for (const TodPoint& point : curve->points) shown[point.set_delta_t_k] = point.delta_t_k;
  const auto outcome = fit_twin_shapes(*curve, trials, twin, {}, direct_options(*curve, twin, shown, seed, {}));
  EXPECT_TRUE(outcome.notes.empty()) << outcome.notes.front();
  add_results(results, design, seed, "default", *curve);
  return results;
}

/// Camera and twin by common phases, beside two estimators of the same run that know nothing of them. In a row of
/// "paired" the size is the ratio of acuities camera / twin with its interval, and `clusters` its degrees of freedom
/// and one.
inline std::vector<GradedResult> paired_results_of(const GradedDesign& design, std::uint64_t seed) {
  const Plan plan = plan_of(design, seed);
  const ExperimentInputs camera = inputs_of(plan, design.camera), twin = inputs_of(plan, design.twin);
  const std::vector<Trial> graded = trials_of(plan, camera);
  std::vector<Trial> binary = graded;
  for (Trial& trial : binary) trial.probability_correct.reset();
  std::vector<GradedResult> results;
  if (const auto curve = tod_curve(binary, {.with_posterior = false}))
    add_results(results, design, seed, "binary weibull", *curve);
  auto curve = tod_curve(graded, {.with_posterior = false});
  EXPECT_TRUE(curve) << design.name << " " << seed;
  if (!curve) return results;
  std::map<double, double> shown;
  for (const TodPoint& point : curve->points) shown[point.set_delta_t_k] = point.delta_t_k;
  const auto shaped = fit_twin_shapes(*curve, graded, twin, {}, direct_options(*curve, twin, shown, seed, {}));
  EXPECT_TRUE(shaped.notes.empty()) << shaped.notes.front();
  add_results(results, design, seed, "graded twin-shape", *curve);
  Comparison comparison;
  for (const TodPoint& point : curve->points)
    comparison.points.push_back({.set_delta_t_k = point.set_delta_t_k, .margin_percent = 3});
  const auto outcome =
      add_paired_ratios(comparison, {*curve, graded, {}}, twin, paired_options(twin, {}, plan.seed, {}));
  EXPECT_TRUE(outcome.notes.empty()) << outcome.notes.front();
  for (const ComparisonPoint& point : comparison.points) {
    if (!point.paired) continue;
    results.push_back({design.name, seed, point.set_delta_t_k, "paired", point.paired->ratio, *point.paired->ci95.low,
                       *point.paired->ci95.high, 100 * point.paired->se_ln_ratio, point.paired->degrees_of_freedom + 1,
                       point.paired->twin_share});
  }
  return results;
}

/// The size at 75 % of the camera itself: `parts` times 8000 draws at the level reference.
inline std::map<double, double> true_s75_mrad(const GradedDesign& design, const std::vector<double>& contrasts,
                                              int parts) {
  const Plan plan = plan_of(design, 1);
  const ExperimentInputs inputs = inputs_of(plan, design.camera);
  TemplateObserver observer(inputs.observer, triangle_alternatives());
  std::map<double, double> truth;
  Accuracy accuracy = Accuracy::reference();
  accuracy.noise_draws = Accuracy::max_noise_draws;
  accuracy.standard_error_percent = 0;
  for (const double contrast : contrasts) {
    double sum = 0;
    for (int part = 0; part < parts; ++part) {
      const auto found = direct_estimate(inputs.sensor, inputs.effects, observer, {contrast},
                                         {.accuracy = accuracy, .seed = 1000000 + static_cast<std::uint64_t>(part)});
      sum += std::log(found.value()[0].s75_pitch);
    }
    truth[contrast] = std::exp(sum / parts) * inputs.sensor.ifov_mrad();
  }
  return truth;
}

/// Rows of a study in a file, so that it can be resumed.
class GradedRecord {
 public:
  explicit GradedRecord(std::string file) : file_(std::move(file)) {
    std::ifstream in(file_);
    std::string line;
    while (std::getline(in, line)) {
      std::istringstream fields(line);
      GradedResult row;
      std::getline(fields, row.design, ',');
      std::string text;
      std::getline(fields, text, ',');
      row.seed = std::stoull(text);
      std::getline(fields, text, ',');
      row.delta_t_k = std::stod(text);
      std::getline(fields, row.estimator, ',');
      for (double* value :
           {&row.s75_mrad, &row.low_mrad, &row.high_mrad, &row.se_percent, &row.clusters, &row.slope_fitted}) {
        std::getline(fields, text, ',');
        *value = std::stod(text);
      }
      rows_.push_back(std::move(row));
    }
    for (const GradedResult& row : rows_) done_.insert({row.design, row.seed});
  }

  [[nodiscard]] bool has(const std::string& design, std::uint64_t seed) const { return done_.contains({design, seed}); }
  [[nodiscard]] const std::vector<GradedResult>& rows() const { return rows_; }

  void append(const std::vector<GradedResult>& results) {
    std::ofstream out(file_, std::ios::app);
    out.precision(12);
    for (const GradedResult& r : results) {
      out << r.design << "," << r.seed << "," << r.delta_t_k << "," << r.estimator << "," << r.s75_mrad << ","
          << r.low_mrad << "," << r.high_mrad << "," << r.se_percent << "," << r.clusters << "," << r.slope_fitted
          << "\n";
      rows_.push_back(r);
      done_.insert({r.design, r.seed});
    }
  }

 private:
  std::string file_;
  std::vector<GradedResult> rows_;
  std::set<std::pair<std::string, std::uint64_t>> done_;
};

/// What came of one estimator at one contrast.
struct GradedSummary {
  int runs = 0;
  double bias_percent = 0, scatter_percent = 0, stated_percent = 0, half_width_percent = 0, coverage = 0,
         slope_fitted = 0;
};

inline GradedSummary summary_of(const std::vector<GradedResult>& rows, const std::string& design, double delta_t_k,
                                const std::string& estimator, double truth_mrad) {
  GradedSummary out;
  double squares = 0;
  for (const GradedResult& row : rows) {
    if (row.design != design || row.delta_t_k != delta_t_k || row.estimator != estimator) continue;
    const double error = 100 * std::log(row.s75_mrad / truth_mrad);
    ++out.runs;
    out.bias_percent += error;
    squares += error * error;
    out.stated_percent += row.se_percent;
    out.half_width_percent += 50 * std::log(row.high_mrad / row.low_mrad);
    out.coverage += row.low_mrad <= truth_mrad && truth_mrad <= row.high_mrad ? 1 : 0;
    out.slope_fitted += row.slope_fitted;
  }
  if (out.runs < 2) return out;
  const double n = out.runs;
  out.bias_percent /= n;
  out.scatter_percent = std::sqrt((squares - n * out.bias_percent * out.bias_percent) / (n - 1));
  for (double* value : {&out.stated_percent, &out.half_width_percent, &out.coverage, &out.slope_fitted}) *value /= n;
  return out;
}

}  // namespace todbench::testing
