// SPDX-License-Identifier: GPL-3.0-or-later
// Cases in which a program tends to report an invented number: a verdict, a refusal or a finite number is required.
#include <algorithm>
#include <cmath>
#include <limits>

#include "bench/selftest/selftest_cases.h"
#include "hvs/observer/known_position.h"
#include "hvs/observer/template_observer.h"
#include "tod/plate/test_pattern.h"
#include "tod/range/range_prediction.h"

namespace todbench {
namespace {

void add(SelftestCases& cases, std::string name, double value, double expected, double tolerance = 0) {
  cases.push_back({"hard case", std::move(name), value, expected, tolerance});
}

bool finite_where_given(const PsychometricFit& fit) {
  for (const auto& value :
       {fit.threshold, fit.slope, fit.ci95.low, fit.ci95.high, fit.log_likelihood, fit.deviance, fit.se_ln_threshold}) {
    if (value && !std::isfinite(*value)) return false;
  }
  return true;
}

/// Numbers that are not finite, over every table of 0 to 3 right answers of 3 at three sizes.
void add_small_tables(SelftestCases& cases) {
  int refused = 0;
  for (const double spread : {1.001, 2.0, 1e6}) {
    for (int code = 0; code < 64; ++code) {
      const auto right = [code](int digit) { return static_cast<double>(code >> (2 * digit) & 3); };
      const std::vector<Level> levels{{1 / spread, right(0), 3, -1}, {1, right(1), 3, -1}, {spread, right(2), 3, -1}};
      for (const PsychometricForm form : {PsychometricForm::size, PsychometricForm::acuity}) {
        const auto fit = fit_psychometric(levels, {.form = form, .with_posterior = false});
        refused += fit && finite_where_given(*fit) ? 0 : 1;
      }
    }
  }
  add(cases, "384 fits of every small table of counts: fits with a number that is not finite", refused, 0);
}

void add_verdicts(SelftestCases& cases) {
  const auto has = [&](const std::string& name, const std::vector<Level>& levels, FitVerdict verdict) {
    const auto fit = fit_psychometric(levels, {});
    add(cases, name, fit && fit->verdict == verdict && !fit->threshold ? 1 : 0, 1);
  };
  has("one size: no threshold", {{1.7, 15, 20, -1}}, FitVerdict::slope_unidentifiable);
  has("perfect separation: no threshold", {{0.5, 5, 20, -1}, {1, 5, 20, -1}, {2, 20, 20, -1}, {4, 20, 20, -1}},
      FitVerdict::step);
  has("larger triangles are answered worse: no threshold",
      {{0.5, 18, 20, -1}, {1, 15, 20, -1}, {2, 12, 20, -1}, {4, 9, 20, -1}}, FitVerdict::flat_or_decreasing);
}

void add_noise_extremes(SelftestCases& cases) {
  KnownPositionTask task;
  task.mean = {1, 0, 0, 0};
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) task.gram[i][j] = i == j ? 1 : 0.9;
  }
  task.noise = 1e-300;
  add(cases, "choice of four with noise of 1e-300 of the signal", probability_correct(task, 64), 1, 1e-12);
  task.noise = 1e300;
  add(cases, "choice of four with noise of 1e300 of the signal", probability_correct(task, 64), 0.25, 1e-5);
}

/// An even picture gives equal scores: the answers must be random. The tolerance is 4.5 standard deviations of a
/// binomial number.
void add_equal_scores(SelftestCases& cases) {
  TemplateObserverSpec spec;
  spec.internal_noise = 0;
  TemplateObserver observer(spec, triangle_alternatives());
  const auto prepared = observer.prepare(2.0, 1);
  constexpr int trials = 2000;
  int up = 0;
  if (prepared) {
    Patch flat;
    flat.kelvin = cv::Mat1d((*prepared)->window_samples(), (*prepared)->window_samples(), 300);
    for (int i = 0; i < trials; ++i) {
      const auto stream = RandomStream(5, "ties").sub(static_cast<std::uint64_t>(i));
      up += (*prepared)->choose(flat, 1, stream).alternative == static_cast<int>(Apex::up) ? 1 : 0;
    }
  }
  add(cases, "equal scores: share of one answer of four", up / double{trials}, 0.25,
      4.5 * std::sqrt(3.0 / 16 / trials));
}

void add_refusals(SelftestCases& cases) {
  TemplateObserver observer({}, triangle_alternatives());
  add(cases, "templates that exceed the memory are refused", observer.prepare(500, 1) ? 0 : 1, 1);
  const std::vector<TodThreshold> curve{{16.9, 1.5, {1.4, 1.6}}, {0.23, 2.6, {2.4, 2.8}}};
  const auto hidden = predict_range(curve, {.size_m = 5, .delta_t_k = 1e-12});
  add(cases, "a contrast below the curve has no range", hidden && !hidden->r75_m ? 1 : 0, 1);
  const std::vector<Level> broken{{1, std::numeric_limits<double>::quiet_NaN(), 20, -1}};
  add(cases, "a NaN among the counts is refused", fit_psychometric(broken, {}) ? 0 : 1, 1);
}

}  // namespace

void add_hard_cases(SelftestCases& cases) {
  add_small_tables(cases);
  add_verdicts(cases);
  add_noise_extremes(cases);
  add_equal_scores(cases);
  add_refusals(cases);
}

}  // namespace todbench
