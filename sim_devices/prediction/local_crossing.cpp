// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/local_crossing.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace todbench {
namespace {

/// P and its slope for a value `eta` of the transform of P.
struct OfTransform {
  explicit OfTransform(double eta) {
    const double odds = std::exp(std::clamp(eta, -12.0, 12.0));
    p = (0.25 + odds) / (1 + odds);
    slope = 0.75 * odds / ((1 + odds) * (1 + odds));
  }
  double p = 0, slope = 0;
};

/// Coefficients of the quadratic, and the influence of each proportion on them.
struct LocalFit {
  Eigen::Vector3d c{std::numbers::ln2, 5, 0};
  Eigen::MatrixXd influence;  ///< of each proportion on the coefficients
};

/// Quasi-likelihood with the variance p (1 - p) of the fitted P as weights (McCullagh and Nelder 1989): the weights do
/// not depend on the random results, and P = 1 needs no special case. `kernel`: additional weights. Starts at `fit`.
std::optional<LocalFit> local_fit(LocalFit fit, const std::vector<double>& xs, const std::vector<Proportion>& ps,
                                  const std::vector<double>& kernel) {
  fit.influence.resize(3, static_cast<Eigen::Index>(xs.size()));
  for (int iteration = 0; iteration < 60; ++iteration) {
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d score = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < xs.size(); ++i) {
      const Eigen::Vector3d row(1, xs[i], xs[i] * xs[i]);
      const OfTransform at(row.dot(fit.c));
      const Eigen::Vector3d weighted = kernel[i] * at.slope / (at.p * (1 - at.p)) * row;
      information += at.slope * weighted * row.transpose();
      score += (ps[i].mean - at.p) * weighted;
      fit.influence.col(static_cast<Eigen::Index>(i)) = weighted;
    }
    const Eigen::LDLT<Eigen::Matrix3d> solver(information);
    Eigen::Vector3d step = solver.solve(score);
    fit.influence = solver.solve(fit.influence).eval();
    if (!step.allFinite()) return std::nullopt;
    // Damped: far from the solution a step may leave the range in which P is informative.
    step *= std::min(1.0, 2 / step.cwiseAbs().cwiseProduct(Eigen::Vector3d(1, 0.1, 0.01)).maxCoeff());
    fit.c += step;
    if (step.cwiseAbs().maxCoeff() < 1e-10) break;
  }
  return fit;
}

/// Root of a rising quadratic minus ln 2 by Newton's method from `x`; the quadratic is nearly straight there.
std::optional<double> root(const Eigen::Vector3d& c, double x) {
  for (int iteration = 0; iteration < 50; ++iteration) {
    const double slope = c(1) + 2 * c(2) * x;
    if (!(slope > 0)) return std::nullopt;
    const double step = (c(0) + c(1) * x + c(2) * x * x - std::numbers::ln2) / slope;
    x -= step;
    if (std::abs(x) > 0.5) return std::nullopt;
    if (std::abs(step) < 1e-13) break;
  }
  return x;
}

/// Fit with weights that fall with the distance from `middle` and vanish three steps away.
std::optional<LocalFit> fit_around(double middle, const LocalFit& start, const std::vector<double>& xs,
                                   const std::vector<Proportion>& ps) {
  const double reach = 3 * (xs[1] - xs[0]);
  std::vector<double> kernel;
  // If `middle` is beyond the available sizes, the farthest ones still determine the quadratic.
  for (const double at : xs) kernel.push_back(std::max(1e-3, 1 - std::pow((at - middle) / reach, 2)));
  return local_fit(start, xs, ps, kernel);
}

}  // namespace

std::optional<Crossing> local_crossing(const std::vector<double>& xs, const std::vector<Proportion>& ps) {
  double x = (xs.front() + xs.back()) / 2;
  LocalFit fit;
  for (int iteration = 0; iteration < 20; ++iteration) {
    const auto found = fit_around(x, fit, xs, ps);
    if (!found) return std::nullopt;
    fit = *found;
    const auto moved = root(fit.c, x);
    if (!moved) return std::nullopt;
    const bool settled = std::abs(*moved - x) < 1e-7;
    x = *moved;
    if (settled) break;
  }
  const Eigen::VectorXd on_value = fit.influence.transpose() * Eigen::Vector3d(1, x, x * x);
  double variance = 0;
  for (std::size_t i = 0; i < ps.size(); ++i)
    variance += std::pow(on_value(static_cast<Eigen::Index>(i)), 2) * std::max(ps[i].variance, 1e-8);
  const double aside = 0.25 * (xs[1] - xs[0]);
  const auto lower = fit_around(x - aside, fit, xs, ps), upper = fit_around(x + aside, fit, xs, ps);
  const auto from = lower ? root(lower->c, x) : std::nullopt, to = upper ? root(upper->c, x) : std::nullopt;
  const double follows = from && to ? std::clamp((*to - *from) / (2 * aside), -0.5, 0.5) : 0.0;
  return Crossing{x, std::sqrt(variance) / (fit.c(1) + 2 * fit.c(2) * x) / (1 - follows)};
}

}  // namespace todbench
