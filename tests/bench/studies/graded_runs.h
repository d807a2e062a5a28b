// SPDX-License-Identifier: GPL-3.0-or-later
// Whole simulated runs with graded answers, and what every estimator makes of the same run.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "bench/forecast/prediction.h"
#include "bench/plan/plan_options.h"
#include "bench/twin/background_twin_functions.h"
#include "bench/twin/paired_comparison.h"
#include "bench/twin/simulated_set_up.h"
#include "bench/twin/twin_shapes.h"
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
  double distance_m = 2;                   ///< with that of the camera the shipped plates suit 2.6 mm a pixel
  std::optional<ViewedDisplay> display{};  ///< of hvs-2, which judges in place of hvs-1
  double adaptive_percent = 0;             ///< half-width at which an adaptive schedule ends; 0: constant stimuli
};

/// What a plan of defaults shows with a camera of 50 Hz, and the frames that are chosen for it (with_frames()).
inline GradedDesign default_design() {
  return {.name = "default", .frames = {4, 8, 8}};
}

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
  plan.target.distance_m = design.distance_m;
  plan.simulation.phases = design.phases;
  plan.simulation.microscan = design.microscan;
  plan.schedule.answers = AnswersChoice::graded;
  plan.schedule.frames_per_presentation = design.frames;
  plan.camera.pixel_aspect = design.camera.pitch_aspect();
  plan.fit.estimator = EstimatorChoice::twin_shape;
  if (!design.display) return plan;
  plan.observer = "hvs-2";
  plan.display = *design.display;
  return plan;
}

inline ExperimentInputs inputs_of(const Plan& plan, const SensorSpec& sensor) {
  ExperimentInputs inputs;
  PlanParts parts = LoadedPlan::load(plan).value().parts();
  inputs.plates = parts.plates;
  inputs.observer = parts.observer;
  inputs.observer.sample_aspect = sensor.pitch_aspect();
  inputs.sensor = sensor;
  inputs.sensor.microscan = plan.simulation.microscan;
  inputs.effects = full_plan(inputs.sensor, {}, {});
  inputs.accuracy = accuracy_of(plan).value();
  return inputs;
}

/// What the runs of a design have in common, made once: how the contrast estimate reads the sensor, and functions of
/// the twin, each of 4000 draws of its own. Every function serves all runs of one remainder, a 25th of them.
class DesignParts {
 public:
  static constexpr std::uint64_t functions = 25;

  explicit DesignParts(GradedDesign design) : design_(std::move(design)) {}

  [[nodiscard]] const GradedDesign& design() const { return design_; }

  /// Of simulated_set_up(); empty before the first run.
  std::map<std::string, double> responses;

  /// Of the twin, where a run saw the contrasts nearly as they were set.
  TodCurve known(const TodCurve& curve, std::uint64_t seed) {
    auto& tables = tables_[seed % functions];
    if (tables.empty()) {
      const Plan plan = plan_of(design_, 5'000'000 + seed % functions);
      tables = twin_tables(plan, inputs_of(plan, design_.twin), std::nullopt, {}).value();
    }
    return known_functions(tables, curve);
  }

 private:
  GradedDesign design_;
  std::map<std::uint64_t, std::map<double, ProportionTable>> tables_;
};

/// The trials of a run, `simulate` without its session.
inline std::vector<Trial> trials_of(const Plan& plan, const ExperimentInputs& inputs, DesignParts& parts) {
  auto set_up = simulated_set_up(plan, inputs, {}, {}, {}, parts.responses);
  if (!set_up) {
    ADD_FAILURE() << set_up.error().message;
    return {};
  }
  parts.responses = set_up->options.contrast_response;
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

/// Fits a curve with the functions of the twin, as a session does.
inline void give_functions(TodCurve& curve, const std::vector<Trial>& trials, const ExperimentInputs& twin,
                           std::uint64_t seed, DesignParts& parts) {
  std::map<double, double> shown;
  for (const TodPoint& point : curve.points) shown[point.set_delta_t_k] = point.delta_t_k;
  const TodCurve known = parts.known(curve, seed);
  const auto outcome = fit_twin_shapes(curve, trials, twin, {}, direct_options(curve, twin, shown, seed, {}), &known);
  EXPECT_TRUE(outcome.notes.empty()) << outcome.notes.front();
}

/// Camera and twin by common phases. In a row of "paired" the size is the ratio of acuities camera / twin with its
/// interval, and `clusters` its degrees of freedom and one.
inline void add_pairs(std::vector<GradedResult>& results, const GradedDesign& design, std::uint64_t seed,
                      const TodCurve& curve, const std::vector<Trial>& trials, const ExperimentInputs& twin) {
  Comparison comparison;
  for (const TodPoint& point : curve.points)
    comparison.points.push_back({.set_delta_t_k = point.set_delta_t_k, .margin_percent = 3});
  const auto outcome = add_paired_ratios(comparison, {curve, trials, {}}, twin, paired_options(twin, {}, seed, {}));
  EXPECT_TRUE(outcome.notes.empty()) << outcome.notes.front();
  for (const ComparisonPoint& point : comparison.points) {
    if (!point.paired) continue;
    results.push_back({design.name, seed, point.set_delta_t_k, "paired", point.paired->ratio, *point.paired->ci95.low,
                       *point.paired->ci95.high, 100 * point.paired->se_ln_ratio, point.paired->degrees_of_freedom + 1,
                       point.paired->twin_share});
  }
}

/// The same answers as one bit each and graded, with a Weibull function and with that of the twin; with `pairs` beside
/// the twin by common phases, too.
inline std::vector<GradedResult> results_of(DesignParts& parts, std::uint64_t seed, bool pairs = false) {
  const GradedDesign& design = parts.design();
  const Plan plan = plan_of(design, seed);
  const ExperimentInputs camera = inputs_of(plan, design.camera), twin = inputs_of(plan, design.twin);
  const std::vector<Trial> graded = trials_of(plan, camera, parts), binary = as_binary(graded);
  std::vector<GradedResult> results;
  for (const auto& [trials, kind] : {std::pair(&graded, "graded"), std::pair(&binary, "binary")}) {
    auto curve = tod_curve(*trials, {.with_posterior = false});
    EXPECT_TRUE(curve) << design.name << " " << seed;
    if (!curve) continue;
    add_results(results, design, seed, std::string(kind) + " weibull", *curve);
    give_functions(*curve, *trials, twin, seed, parts);
    add_results(results, design, seed, std::string(kind) + " twin-shape", *curve);
    if (pairs && trials == &graded) add_pairs(results, design, seed, *curve, graded, twin);
  }
  return results;
}

/// What a plan with right and wrong answers and without `estimator` makes of the same run, one frame each, beside what
/// a Weibull function does.
inline std::vector<GradedResult> default_results_of(DesignParts& parts, std::uint64_t seed) {
  const GradedDesign& design = parts.design();
  Plan plan = plan_of(design, seed);
  plan.schedule = {};
  plan.schedule.answers = AnswersChoice::binary;
  plan.fit = {};
  const ExperimentInputs camera = inputs_of(plan, design.camera), twin = inputs_of(plan, design.twin);
  const std::vector<Trial> trials = trials_of(plan, camera, parts);
  std::vector<GradedResult> results;
  auto curve = tod_curve(trials, {.with_posterior = false});
  EXPECT_TRUE(curve) << design.name << " " << seed;
  if (!curve) return results;
  add_results(results, design, seed, "default weibull", *curve);
  give_functions(*curve, trials, twin, seed, parts);
  add_results(results, design, seed, "default", *curve);
  return results;
}

/// The size at 75 % of a camera itself, and its standard error in percent.
struct TrueSize {
  double s75_mrad = 0, se_percent = 0;
};

/// `parts` times 8000 draws at the level reference.
inline std::map<double, TrueSize> true_sizes(const GradedDesign& design, const std::vector<double>& contrasts,
                                             int parts) {
  const Plan plan = plan_of(design, 1);
  const ExperimentInputs inputs = inputs_of(plan, design.camera);
  TemplateObserver observer(inputs.observer, triangle_alternatives());
  std::map<double, TrueSize> truth;
  Accuracy accuracy = Accuracy::reference();
  accuracy.noise_draws = Accuracy::max_noise_draws;
  accuracy.standard_error_percent = 0;
  for (const double contrast : contrasts) {
    double sum = 0, variance = 0;
    for (int part = 0; part < parts; ++part) {
      const auto found = direct_estimate(inputs.sensor, inputs.effects, observer, {contrast},
                                         {.accuracy = accuracy, .seed = 1000000 + static_cast<std::uint64_t>(part)});
      const DirectPoint& point = found.value()[0];
      sum += std::log(point.s75_pitch);
      variance += std::pow(point.standard_error_pitch / point.s75_pitch, 2);
    }
    truth[contrast] = {std::exp(sum / parts) * inputs.sensor.ifov_mrad(), 100 * std::sqrt(variance) / parts};
  }
  return truth;
}

inline std::map<double, double> true_s75_mrad(const GradedDesign& design, const std::vector<double>& contrasts,
                                              int parts) {
  std::map<double, double> truth;
  for (const auto& [contrast, size] : true_sizes(design, contrasts, parts)) truth[contrast] = size.s75_mrad;
  return truth;
}

/// Of several processes that make the runs of a study together: this one makes every `step`-th, from `first` on.
struct StudyShare {
  std::uint64_t first = 1, step = 1;
};

/// TODBENCH_STUDY_SHARE, "2/3" for the second of three.
inline StudyShare study_share() {
  StudyShare share;
  const char* text = std::getenv("TODBENCH_STUDY_SHARE");
  char slash = 0;
  if (text != nullptr) std::istringstream(text) >> share.first >> slash >> share.step;
  return share;
}

/// Rows of a study in a file, so that it can be resumed. A share has a file of its own and knows those of the others.
class GradedRecord {
 public:
  explicit GradedRecord(const std::filesystem::path& file, const StudyShare& share = {}) : file_(file) {
    if (share.step > 1) file_.replace_extension("." + std::to_string(share.first) + file.extension().string());
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(file.parent_path())) {
      const std::string name = entry.path().filename().string();
      if (name.starts_with(file.stem().string() + ".")) files.push_back(entry.path());
    }
    std::ranges::sort(files);
    for (const auto& one : files) read(one);
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
  void read(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::string line;
    while (std::getline(in, line)) {
      std::istringstream text(line);
      std::vector<std::string> fields;
      for (std::string field; std::getline(text, field, ',');) fields.push_back(field);
      // The name of a design may contain commas.
      constexpr std::size_t numbers = 9;
      const std::size_t names = fields.size() - numbers;
      GradedResult row;
      for (std::size_t i = 0; i < names; ++i) row.design += (i > 0 ? "," : "") + fields[i];
      row.seed = std::stoull(fields[names]);
      row.delta_t_k = std::stod(fields[names + 1]);
      row.estimator = fields[names + 2];
      std::size_t next = names + 3;
      for (double* value :
           {&row.s75_mrad, &row.low_mrad, &row.high_mrad, &row.se_percent, &row.clusters, &row.slope_fitted})
        *value = std::stod(fields[next++]);
      rows_.push_back(std::move(row));
    }
  }

  std::filesystem::path file_;
  std::vector<GradedResult> rows_;
  std::set<std::pair<std::string, std::uint64_t>> done_;
};

/// What came of one estimator at one contrast.
struct GradedSummary {
  int runs = 0;
  double bias_percent = 0, scatter_percent = 0, stated_percent = 0, half_width_percent = 0, coverage = 0,
         slope_fitted = 0;
  double nineteen_of_20_percent = 0;  ///< half-width that so many runs stay below
};

/// Half-widths that `plan` with the twin says of a design before it is measured, percent of ln S75 by contrast.
inline std::map<double, double> predicted_half_widths(const GradedDesign& design) {
  const Plan plan = plan_of(design, 1);
  PlanParts parts = LoadedPlan::load(plan).value().parts();
  parts.sensor = design.twin;
  EffectPlanner planner;
  const auto inputs = experiment_inputs(LoadedPlan::of(plan, std::move(parts)).value(), planner).value();
  std::map<double, double> out;
  const PlanPrediction prediction = predict_plan(plan, inputs).value();
  for (const ContrastPrediction& point : prediction.contrasts)
    out[point.delta_t_k] = 100 * std::log1p(point.uncertainty_percent.value() / 100);
  return out;
}

inline GradedSummary summary_of(const std::vector<GradedResult>& rows, const std::string& design, double delta_t_k,
                                const std::string& estimator, double truth_mrad) {
  GradedSummary out;
  double squares = 0;
  std::vector<double> half_widths;
  for (const GradedResult& row : rows) {
    if (row.design != design || row.delta_t_k != delta_t_k || row.estimator != estimator) continue;
    const double error = 100 * std::log(row.s75_mrad / truth_mrad);
    ++out.runs;
    out.bias_percent += error;
    squares += error * error;
    out.stated_percent += row.se_percent;
    half_widths.push_back(50 * std::log(row.high_mrad / row.low_mrad));
    out.half_width_percent += half_widths.back();
    out.coverage += row.low_mrad <= truth_mrad && truth_mrad <= row.high_mrad ? 1 : 0;
    out.slope_fitted += row.slope_fitted;
  }
  if (out.runs < 2) return out;
  const double n = out.runs;
  out.bias_percent /= n;
  out.scatter_percent = std::sqrt((squares - n * out.bias_percent * out.bias_percent) / (n - 1));
  for (double* value : {&out.stated_percent, &out.half_width_percent, &out.coverage, &out.slope_fitted}) *value /= n;
  std::ranges::sort(half_widths);
  out.nineteen_of_20_percent = half_widths[static_cast<std::size_t>(0.95 * (n - 1))];
  return out;
}

}  // namespace todbench::testing
