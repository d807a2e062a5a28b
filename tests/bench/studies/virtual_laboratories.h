// SPDX-License-Identifier: GPL-3.0-or-later
// Virtual laboratories one by one, kept in a file, and what they say of a budget.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <sstream>
#include <stop_token>
#include <string>
#include <vector>

#include "acquisition/base/rng.h"
#include "bench/judgement/limit_decision.h"
#include "tests/bench/studies/graded_runs.h"
#include "tests/bench/studies/virtual_laboratory.h"

namespace todbench::testing {

/// Rows as of an ordinary laboratory. The function of the twin leaves 0.1 to 0.2 % of form
/// (docs/validation/coverage.md).
inline std::vector<BudgetRow> rows_of_a_laboratory() {
  using enum BudgetDistribution;
  const auto row = [](const char* name, double value, BudgetDistribution distribution, const char* unit) {
    return BudgetRow{.name = name, .value = value, .distribution = distribution, .unit = unit};
  };
  return {row("distance", 2, rectangular, "mm"),
          row("entrance pupil", 15, rectangular, "mm"),
          row("cut-outs", 0.3, normal, "%"),
          row("black-body-calibration", 8, normal, "mK"),
          row("black-body-emissivity", 1, rectangular, "%"),
          row("black-body-ambient", 5, rectangular, "mK"),
          row("black-body-uniformity", 3, normal, "mK"),
          row("black-body-stability", 4, u_shaped, "mK"),
          row("air-path", 0.5, rectangular, "%"),
          row("camera-scale", 1.5, normal, "%"),
          row("form", 0.2, normal, "%")};
}

inline GradedDesign laboratory_design() {
  return {.name = "laboratory", .phases = 3, .frames = {2}};
}

/// A quarter of the demonstration's presentations: a laboratory takes three seconds.
inline Plan plan_of_laboratories(const GradedDesign& design, std::uint64_t seed) {
  Plan plan = plan_of(design, seed);
  plan.name = "virtual laboratory";
  plan.camera.id = "sim:sc2000";
  plan.camera.ifov_mrad = SensorSpec{}.ifov_mrad();
  plan.target.phases = design.phases;
  plan.uncertainty.rows = rows_of_a_laboratory();
  return plan;
}

/// Points of a study in a file, so that it can be resumed.
class LaboratoryRecord {
 public:
  explicit LaboratoryRecord(std::string file) : file_(std::move(file)) {
    std::ifstream in(file_);
    std::string line;
    while (std::getline(in, line)) {
      std::istringstream fields(line);
      LaboratoryPoint point;
      double freedom = 0;
      std::string end;
      fields >> point.laboratory;
      for (double* value : numbers(point)) fields >> *value;
      fields >> freedom >> end;
      if (!end.empty() && end != "end") {  // lines without the uncertainty of the trials are read, too
        double trials_freedom = 0;
        point.u_trials = std::strtod(end.c_str(), nullptr);
        fields >> trials_freedom >> end;
        if (trials_freedom > 0) point.trials_freedom = trials_freedom;
      }
      if (end != "end") break;  // a line that was cut off
      if (freedom > 0) point.degrees_of_freedom = freedom;
      points_.push_back(point);
      done_.insert(point.laboratory);
    }
  }

  [[nodiscard]] bool has(std::uint64_t laboratory) const { return done_.contains(laboratory); }
  [[nodiscard]] const std::vector<LaboratoryPoint>& points() const { return points_; }

  void append(const std::vector<LaboratoryPoint>& points) {
    std::ofstream out(file_, std::ios::app);
    out.precision(12);
    for (LaboratoryPoint point : points) {
      out << point.laboratory;
      for (const double* value : numbers(point)) out << " " << *value;
      out << " " << point.degrees_of_freedom.value_or(0) << " " << point.u_trials << " "
          << point.trials_freedom.value_or(0) << " end\n";
      points_.push_back(point);
      done_.insert(point.laboratory);
    }
  }

 private:
  static std::vector<double*> numbers(LaboratoryPoint& p) {
    return {&p.delta_t_k, &p.seen_delta_t_k, &p.s75_mrad, &p.statistical_low, &p.statistical_high,
            &p.low,       &p.high,           &p.u,        &p.contrast_slope};
  }

  std::string file_;
  std::vector<LaboratoryPoint> points_;
  std::set<std::uint64_t> done_;
};

/// By which way a laboratory is measured.
using MeasureLaboratory = std::function<Result<std::vector<LaboratoryPoint>>(
    const Plan& plan, const ExperimentInputs& inputs, std::uint64_t laboratory, std::stop_token stop)>;

/// Makes the laboratories that the record does not have. Numbers begin with 1.
inline void run_laboratories(LaboratoryRecord& record, const GradedDesign& design, const Plan& plan,
                             std::uint64_t laboratories, const MeasureLaboratory& measure = measured_by_laboratory) {
  const ExperimentInputs inputs = inputs_of(plan, design.camera);
  for (std::uint64_t laboratory = 1; laboratory <= laboratories; ++laboratory) {
    if (record.has(laboratory)) continue;
    const auto points = measure(plan, inputs, laboratory, {});
    ASSERT_TRUE(points) << points.error().message;
    ASSERT_EQ(points->size(), design.delta_t_k.size());
    record.append(*points);
  }
}

inline std::vector<LaboratoryPoint> points_at(const std::vector<LaboratoryPoint>& points, double delta_t_k) {
  std::vector<LaboratoryPoint> out;
  for (const LaboratoryPoint& point : points)
    if (point.delta_t_k == delta_t_k) out.push_back(point);
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.laboratory < b.laboratory; });
  return out;
}

/// By which the errors that a laboratory has drawn move ln S75 at a contrast of the plan, with this slope.
inline double drawn_part(const Plan& plan, const LaboratoryErrors& errors, std::size_t contrast, double slope) {
  const auto ln_of = [](double stated, const InputError& error) {
    return std::log1p(error.relative + error.absolute / stated);
  };
  return ln_of(plan.target.distance_m, errors.distance_m) - std::log1p(errors.cut_outs_m.relative) -
         slope * ln_of(plan.target.delta_t_k[contrast], errors.contrasts_k[contrast]);
}

/// Mean of it over the laboratories that measured the contrast, %: what a mean of laboratories is off by chance.
inline double drawn_bias_percent(const Plan& plan, const std::vector<LaboratoryPoint>& points) {
  double sum = 0, slope = 0;
  for (const LaboratoryPoint& point : points) slope += point.contrast_slope / static_cast<double>(points.size());
  for (const LaboratoryPoint& point : points) {
    const auto at = std::find(plan.target.delta_t_k.begin(), plan.target.delta_t_k.end(), point.delta_t_k);
    sum += drawn_part(plan, drawn_errors(plan, plan.seed, point.laboratory),
                      static_cast<std::size_t>(at - plan.target.delta_t_k.begin()), slope);
  }
  return 100 * sum / static_cast<double>(points.size());
}

/// What the laboratories say of one contrast.
struct LaboratorySummary {
  int laboratories = 0, pairs = 0;
  double bias_percent = 0, scatter_percent = 0;  ///< of ln S75
  double u_percent = 0;                          ///< that the budgets state, root of the mean square
  double half_width_percent = 0;                 ///< expanded, mean
  double statistical_coverage = 0, coverage = 0, coverage_k2 = 0;
  double within_one = 0;  ///< |E_n| <= 1 of pairs
  double slope = 0;       ///< that the budgets took, mean
};

inline LaboratorySummary summary_of(const std::vector<LaboratoryPoint>& points, double truth_mrad) {
  LaboratorySummary out;
  out.laboratories = static_cast<int>(points.size());
  const double n = out.laboratories;
  double squares = 0, u_squares = 0;
  for (const LaboratoryPoint& p : points) {
    const double error = 100 * std::log(p.s75_mrad / truth_mrad);
    out.bias_percent += error / n;
    squares += error * error;
    u_squares += 1e4 * p.u * p.u / n;
    out.half_width_percent += 50 * std::log(p.high / p.low) / n;
    out.statistical_coverage += (p.statistical_low <= truth_mrad && truth_mrad <= p.statistical_high ? 1 : 0) / n;
    out.coverage += (p.low <= truth_mrad && truth_mrad <= p.high ? 1 : 0) / n;
    out.coverage_k2 += (std::abs(error) <= 200 * p.u ? 1 : 0) / n;
    out.slope += p.contrast_slope / n;
  }
  out.scatter_percent = std::sqrt(std::max(0.0, squares - n * out.bias_percent * out.bias_percent) / (n - 1));
  out.u_percent = std::sqrt(u_squares);
  for (std::size_t i = 1; i < points.size(); i += 2) {
    ++out.pairs;
    out.within_one += std::abs(normalised_error(points[i - 1], points[i])) <= 1 ? 1 : 0;
  }
  if (out.pairs > 0) out.within_one /= out.pairs;
  return out;
}

inline void print_heading_of_summaries() {
  std::printf(
      "| contrast | laboratories | bias | of it drawn | scatter | u | U | trials alone | coverage | k = 2 | E_n | "
      "slope |\n");
}

inline void print(const LaboratorySummary& s, double contrast, double drawn_percent) {
  std::printf(
      "| %g K | %d | %+.2f %% | %+.2f %% | %.2f %% | %.2f %% | %.2f %% | %.3f | %.3f | %.3f | %.3f of %d | %.3f |\n",
      contrast, s.laboratories, s.bias_percent, drawn_percent, s.scatter_percent, s.u_percent, s.half_width_percent,
      s.statistical_coverage, s.coverage, s.coverage_k2, s.within_one, s.pairs, s.slope);
}

/// Decisions about units whose true acuity lies `offset` (in ln) above what is demanded, by the rule.
struct RuleOutcome {
  double wrongly_accepted = 0, wrongly_rejected = 0;  ///< shares of all
  double stated_if_accepted = 0, wrong_if_accepted = 0;
  double stated_if_rejected = 0, wrong_if_rejected = 0;
};

/// A limit is as far from the acuity of the camera as the unit under test would be from it. Offsets over all of
/// +- `reach` with equal weight: little prior knowledge, as the stated risks assume.
inline RuleOutcome outcome_of(const std::vector<LaboratoryPoint>& points, double truth_mrad, ConformityRule rule,
                              double reach) {
  constexpr int steps = 200;
  RuleOutcome out;
  double accepted = 0, rejected = 0, all = 0;
  for (const LaboratoryPoint& p : points) {
    for (int step = 0; step < steps; ++step) {
      const double offset = reach * (2 * (step + 0.5) / steps - 1);
      const LimitAnswer answer = decide({.value = p.s75_mrad,
                                         .interval = {p.low, p.high},
                                         .limit = truth_mrad * std::exp(offset),
                                         .at_least = false,
                                         .scale = LimitScale::logarithmic,
                                         .degrees_of_freedom = p.degrees_of_freedom},
                                        rule, std::nullopt);
      const bool conforming = offset >= 0;
      ++all;
      if (answer.decision == ConformityDecision::pass) {
        ++accepted;
        out.stated_if_accepted += 1 - answer.p_conformity.value();
        if (!conforming) ++out.wrongly_accepted;
      } else if (answer.decision == ConformityDecision::fail) {
        ++rejected;
        out.stated_if_rejected += answer.p_conformity.value();
        if (conforming) ++out.wrongly_rejected;
      }
    }
  }
  if (accepted > 0) out.stated_if_accepted /= accepted, out.wrong_if_accepted = out.wrongly_accepted / accepted;
  if (rejected > 0) out.stated_if_rejected /= rejected, out.wrong_if_rejected = out.wrongly_rejected / rejected;
  if (all > 0) out.wrongly_accepted /= all, out.wrongly_rejected /= all;
  return out;
}

/// Of laboratories that judge a unit exactly on the limit: those that accept it.
inline double accepted_on_the_limit(const std::vector<LaboratoryPoint>& points, double truth_mrad) {
  double accepted = 0;
  for (const LaboratoryPoint& p : points) accepted += p.high <= truth_mrad ? 1 : 0;
  return points.empty() ? 0 : accepted / static_cast<double>(points.size());
}

}  // namespace todbench::testing
