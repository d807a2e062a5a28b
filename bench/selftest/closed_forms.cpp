// SPDX-License-Identifier: GPL-3.0-or-later
// Cases with an answer in closed form.
#include <array>
#include <cmath>
#include <numbers>

#include "bench/judgement/conformity.h"
#include "bench/selftest/selftest_cases.h"
#include "hvs/observer/known_position.h"
#include "hvs/shape/polygon_spectrum.h"
#include "tod/measures/signal_transfer.h"
#include "tod/plate/test_pattern.h"
#include "tod/range/range_prediction.h"

namespace todbench {
namespace {

class Closed {
 public:
  explicit Closed(SelftestCases& cases) : cases_(cases) {}
  void add(std::string name, std::optional<double> value, double expected, double tolerance) {
    cases_.push_back({"closed form", std::move(name), value.value_or(NAN), expected, tolerance});
  }

 private:
  SelftestCases& cases_;
};

void add_shapes(Closed& out) {
  const Polygon shape = triangle(1.7, Apex::up, {0.3, -0.2});
  out.add("area of a triangle of 1.7 pitches", area(shape), 1.7 * 1.7, 1e-14);
  out.add("spectrum at frequency 0: the area", polygon_spectrum(shape, 0, 0).real(), 1.7 * 1.7, 1e-14);
  const Polygon square{{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
  const auto sinc = [](double x) { return std::sin(std::numbers::pi * x) / (std::numbers::pi * x); };
  out.add("spectrum of a square: product of two sincs", polygon_spectrum(square, 0.3, 0.7).real(),
          sinc(0.3) * sinc(0.7), 1e-14);
}

/// Limits of the steepest curve (slope 50) for answers that are all right or all wrong: n ln psi has fallen by
/// 2.7055 / 2 at the limit.
void add_one_sided_limits(Closed& out) {
  const double half_drop = 2.705543454095404 / 2, steepest = 50;
  for (const double n : {10.0, 1e6}) {
    const std::string trials = n == 10 ? "10 trials" : "10^6 trials";
    const auto right = fit_psychometric(std::vector<Level>{{1.7, n, n, -1}}, {});
    const double z_right = -std::log(-std::expm1(-half_drop / n) / 0.75);
    out.add("upper limit, all of " + trials + " right", right ? right->ci95.high : std::nullopt,
            1.7 * std::exp(-std::log(z_right / std::log(3.0)) / steepest), 2e-7);
    const auto wrong = fit_psychometric(std::vector<Level>{{1.7, 0, n, -1}}, {});
    out.add("lower limit, all of " + trials + " wrong", wrong ? wrong->ci95.low : std::nullopt,
            1.7 * std::exp(-std::log(half_drop / n / std::log(3.0)) / steepest), 2e-7);
  }
}

/// Four equally correlated variables: their common part drops out of the comparison, so the probability is that of
/// independent ones, whatever the correlation.
void add_orthants(Closed& out) {
  for (const double gap : {1e-4, 1e-12}) {
    KnownPositionTask task;
    const double correlation = 1 - gap;
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j < 4; ++j) task.gram[i][j] = i == j ? 1 : correlation;
    }
    const std::string name = gap > 1e-6 ? "correlation 1 - 1e-4" : "correlation 1 - 1e-12";
    out.add("choice of four without signal, " + name, probability_correct(task, 96), 0.25, 1e-5);
    // Integral of phi(x - d') Phi(x)^3 at d' = 1.
    task.mean[0] = std::sqrt(1 - correlation);
    out.add("choice of four at d' = 1, " + name, probability_correct(task, 96), 0.5520314384429, 1e-5);
  }
}

void add_lines_and_limits(Closed& out) {
  std::vector<TemperatureStep> steps;
  for (const double k : {-2.0, -1.0, 0.0, 1.0, 2.0}) steps.push_back({.delta_t_k = k, .signal = 0.98 * k + 0.01});
  const auto line = signal_transfer(steps);
  out.add("slope of a straight line", line ? std::optional(line->slope) : std::nullopt, 0.98, 1e-14);
  const auto found = conformity({.value = 1, .u = 1}, {.at_least = -1, .at_most = 3}, ConformityRule::simple, 0);
  out.add("normal probability within two standard deviations",
          found ? std::optional(found->p_conformity) : std::nullopt, 0.954499736103642, 1e-12);
}

void add_ranges(Closed& out) {
  const std::vector<TodThreshold> curve{{16.9, 1.5, {1.4, 1.6}}, {1.93, 1.8, {1.7, 1.9}}, {0.23, 2.6, {2.4, 2.8}}};
  for (const double size_m : {1e-9, 5.0, 1e6}) {
    const auto found = predict_range(curve, {.size_m = size_m, .delta_t_k = 16.9});
    const double expected = 1000 * size_m / 1.5 / 5.1;
    out.add("range without air of a target of " +
                std::string(size_m < 1    ? "1e-9"
                            : size_m < 10 ? "5"
                                          : "1e6") +
                " m",
            found ? found->r75_m : std::nullopt, expected, 1e-12 * expected);
  }
}

}  // namespace

void add_closed_forms(SelftestCases& cases) {
  Closed out(cases);
  add_shapes(out);
  add_one_sided_limits(out);
  add_orthants(out);
  add_lines_and_limits(out);
  add_ranges(out);
}

}  // namespace todbench
