// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/drift_law.h"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <functional>
#include <optional>

#include "acquisition/base/distributions.h"
#include "acquisition/base/normal.h"
#include "acquisition/base/try.h"
#include "tod/measures/shading.h"

namespace todbench {
namespace {

constexpr double drift_test_level = 0.01;
constexpr double surface_parameters = 6;  // level and shading of second order
constexpr int time_constants = 60;        // of the grid
constexpr double longest_over_span = 10;  // a longer time constant is like a straight line

using Column = cv::Mat1d;

Column growth(const std::vector<double>& time_s, std::optional<double> time_constant_s) {
  Column f(static_cast<int>(time_s.size()), 1);
  for (int k = 0; k < f.rows; ++k) {
    const double t = time_s[static_cast<std::size_t>(k)] - time_s.front();
    f(k, 0) = time_constant_s ? -std::expm1(-t / *time_constant_s) : t;
  }
  return f;
}

/// Times of groups, and the roots of their weights: frames over the mean number of frames, because the mean of few
/// frames is less certain.
struct GroupTimes {
  std::vector<double> time_s;
  Column root_weight;

  /// Rows without their weighted mean, times the roots of the weights, so that white noise is equal in all rows.
  [[nodiscard]] cv::Mat1d whitened(const cv::Mat1d& rows) const {
    cv::Mat1d out = rows.clone(), mean = cv::Mat1d::zeros(1, rows.cols);
    for (int k = 0; k < rows.rows; ++k) mean += rows.row(k) * (root_weight(k, 0) * root_weight(k, 0) / rows.rows);
    for (int k = 0; k < rows.rows; ++k) out.row(k) = (rows.row(k) - mean) * root_weight(k, 0);
    return out;
  }
};

/// A vector without its mean, normalised to length 1, and its original length.
struct Direction {
  Column unit;
  double length = 0;
};

Direction direction_of(const GroupTimes& groups, std::optional<double> time_constant_s) {
  Direction out{groups.whitened(growth(groups.time_s, time_constant_s)), 0};
  out.length = cv::norm(out.unit);
  out.unit /= out.length;
  return out;
}

/// Sums of squares of one or many series with common times. `products`: sum over the series of their products between
/// groups, for series without their means over the groups.
struct Regression {
  const GroupTimes& groups;
  cv::Mat1d products;
  double series = 1;  ///< degrees of freedom of each group

  [[nodiscard]] double total() const { return cv::trace(products)[0]; }
  [[nodiscard]] double explained(std::optional<double> time_constant_s) const {
    const Column u = direction_of(groups, time_constant_s).unit;
    const cv::Mat1d out = u.t() * products * u;
    return out(0, 0);
  }
  [[nodiscard]] double left(std::optional<double> time_constant_s) const {
    return std::max(0.0, total() - explained(time_constant_s));
  }
  /// Degrees of freedom of the residuals of a straight line.
  [[nodiscard]] double freedom() const { return series * (static_cast<double>(groups.time_s.size()) - 2); }
};

struct TimeConstant {
  double best_s = 0;
  Interval ci95{};
  double left = 0;  ///< residual sum of squares
};

/// Time constant of the least sum of squares, by the grid and Brent's method (1973); its interval is the range in which
/// the sum of squares exceeds the minimum by chance only.
TimeConstant best_time_constant(const Regression& data) {
  const std::vector<double>& time_s = data.groups.time_s;
  const double span = time_s.back() - time_s.front();
  const double low = std::log(span / static_cast<double>(time_s.size())), high = std::log(longest_over_span * span);
  const auto left = [&](double log_s) { return data.left(std::exp(log_s)); };
  const double step = (high - low) / time_constants;
  double best = low;
  for (int i = 1; i <= time_constants; ++i)
    if (left(low + i * step) < left(best)) best = low + i * step;
  constexpr double enough = 1e-6;
  constexpr int minimum_bits = 26;
  best =
      boost::math::tools::brent_find_minima(left, std::max(low, best - step), std::min(high, best + step), minimum_bits)
          .first;
  TimeConstant out{std::exp(best), {}, left(best)};
  const double freedom = data.freedom() - 1;
  const double f95 = quantile(distribution::FisherF(1, freedom), 0.95);
  const double bound = out.left * (1 + f95 / freedom);
  const auto side = [&](double end) -> std::optional<double> {
    if (left(end) <= bound) return std::nullopt;
    double inside = best, outside = end;
    while (std::abs(outside - inside) > enough)
      (left(0.5 * (inside + outside)) <= bound ? inside : outside) = 0.5 * (inside + outside);
    return std::exp(inside);
  };
  out.ci95 = {.low = side(low), .high = side(high)};
  return out;
}

/// The shape that the data require; returns the best time constant, used or not.
TimeConstant choose_shape(DriftFit& fit, const Regression& data, std::optional<TimeConstant>& constant) {
  const TimeConstant best = best_time_constant(data);
  const double straight = data.left(std::nullopt), freedom = data.freedom() - 1;
  // Squares below a millionth of a kelvin are rounding errors.
  constexpr double exact_k2 = 1e-18;
  const double variance = std::max(best.left, exact_k2 * data.freedom()) / freedom;
  // In the noise of many pixels a search always finds a better shape: the sums of squares along two directions differ
  // by chance by 2 variance sqrt(pixels) sine of the angle between them (standard deviation).
  constexpr double far = 2.5;
  const double along = direction_of(data.groups, std::nullopt).unit.dot(direction_of(data.groups, best.best_s).unit);
  const double by_search = data.series > 1 ? 2 * std::sqrt(data.series * std::max(0.0, 1 - along * along)) : 0;
  const double f = (straight - best.left) / variance - far * by_search;
  fit.p_linear = f > 0 ? cdf(complement(distribution::FisherF(1, freedom), f)) : 1;
  if (fit.p_linear >= drift_test_level) return best;
  constant = best;
  fit.shape = DriftShape::approach;
  fit.time_constant_s = best.best_s, fit.time_constant_ci95 = best.ci95;
  return best;
}

std::optional<double> constant_of(const std::optional<TimeConstant>& constant) {
  return constant ? std::optional(constant->best_s) : std::nullopt;
}

/// Rows of `series` are groups.
Regression regression_of(const GroupTimes& groups, const cv::Mat1d& series, double freedom) {
  const cv::Mat1d white = groups.whitened(series);
  return {groups, white * white.t(), freedom};
}

/// `pattern_u_k`: standard deviation of the mean of the independent changes of the pixels.
DriftFit level_fit(const GroupTimes& groups, const cv::Mat1d& levels, double pattern_u_k) {
  DriftFit fit;
  const std::vector<double>& time_s = groups.time_s;
  const Regression data = regression_of(groups, levels, 1);
  std::optional<TimeConstant> constant;
  static_cast<void>(choose_shape(fit, data, constant));
  const Column f = growth(time_s, constant_of(constant));
  const int last = f.rows - 1;
  // Level, change and, for an approach, the time constant around its best value.
  cv::Mat1d design(f.rows, constant ? 3 : 2);
  design.col(0).setTo(1);
  f.copyTo(design.col(1));
  const auto weighted = [&](const cv::Mat1d& rows) {
    cv::Mat1d out = rows.clone();
    for (int k = 0; k < out.rows; ++k) out.row(k) *= groups.root_weight(k, 0);
    return out;
  };
  cv::Mat1d solution;
  cv::solve(weighted(design.colRange(0, 2)), weighted(levels), solution, cv::DECOMP_SVD);
  fit.fitted_k.resize(time_s.size());
  if (constant) {
    constexpr double relative = 1e-4;
    const Column up = growth(time_s, constant->best_s * (1 + relative));
    const Column down = growth(time_s, constant->best_s * (1 - relative));
    cv::Mat1d(solution(1, 0) * (up - down) / (2 * relative)).copyTo(design.col(2));
  }
  const double freedom = f.rows - design.cols, variance = data.left(constant_of(constant)) / freedom;
  cv::Mat1d covariance;
  const cv::Mat1d white = weighted(design);
  cv::invert(white.t() * white, covariance, cv::DECOMP_SVD);
  const cv::Mat1d gradient = design.row(last) - design.row(0);
  const cv::Mat1d of_change = gradient * covariance * gradient.t();
  fit.change_k = solution(1, 0) * (f(last, 0) - f(0, 0));
  const double half = std::hypot(
      quantile(distribution::StudentsT(freedom), 0.975) * std::sqrt(std::max(0.0, variance * of_change(0, 0))),
      normal_z95 * pattern_u_k);
  fit.change_ci95 = {.low = fit.change_k - half, .high = fit.change_k + half};
  for (int k = 0; k <= last; ++k) {
    fit.seen_k.push_back(levels(k, 0));
    fit.fitted_k[static_cast<std::size_t>(k)] = solution(0, 0) + solution(1, 0) * f(k, 0);
  }
  return fit;
}

struct SignedVariance {
  double value = 0, low = 0, high = 0;
};

/// Variance of (first - second) / divisor, both mean squares (Graybill and Wang 1980, without the cross term).
SignedVariance difference_of(double first, double first_freedom, double second, double second_freedom, double divisor) {
  const distribution::ChiSquared one(first_freedom), two(second_freedom);
  constexpr double each_side = 0.025;
  const auto down = [&](const distribution::ChiSquared& chi, double n) {
    return 1 - n / quantile(complement(chi, each_side));
  };
  const auto up = [&](const distribution::ChiSquared& chi, double n) { return n / quantile(chi, each_side) - 1; };
  const double below = std::hypot(down(one, first_freedom) * first, up(two, second_freedom) * second);
  const double above = std::hypot(up(one, first_freedom) * first, down(two, second_freedom) * second);
  return {(first - second) / divisor, (first - second - below) / divisor, (first - second + above) / divisor};
}

double root_of(double variance) {
  return std::sqrt(std::max(0.0, variance));
}

DriftFit pattern_fit(const GroupTimes& groups, const cv::Mat1d& patterns) {
  DriftFit fit;
  const std::vector<double>& time_s = groups.time_s;
  const double freedom = patterns.cols - surface_parameters;
  const Regression data = regression_of(groups, patterns, freedom);
  std::optional<TimeConstant> constant;
  const TimeConstant best = choose_shape(fit, data, constant);
  const auto left_freedom = data.freedom();
  const auto noise = data.left(constant_of(constant)) / left_freedom;  // of a pixel in a group of mean size
  const auto change = [&](std::optional<double> time_constant_s) {
    const Column f = growth(time_s, time_constant_s);
    const double length = direction_of(groups, time_constant_s).length, step = f(f.rows - 1, 0);
    const SignedVariance size =
        difference_of(data.explained(time_constant_s) / freedom, freedom, noise, left_freedom, length * length);
    return SignedVariance{root_of(size.value) * step, root_of(size.low) * step, root_of(size.high) * step};
  };
  SignedVariance found = change(constant_of(constant));
  fit.change_k = found.value;
  double below = found.value - found.low, above = found.high - found.value;
  // The change also depends on an uncertain time constant, and on an approach too weak to be distinguished from a line.
  const auto join = [&](std::optional<double> time_constant_s) {
    const double moved = time_constant_s ? change(time_constant_s).value - found.value : 0;
    below = std::hypot(below, std::min(0.0, moved)), above = std::hypot(above, std::max(0.0, moved));
  };
  if (constant)
    join(constant->ci95.low), join(constant->ci95.high);
  else
    join(best.best_s);
  fit.change_ci95 = {.low = std::max(0.0, found.value - below), .high = found.value + above};
  const Column f = growth(time_s, constant_of(constant));
  for (int k = 0; k < patterns.rows; ++k) {
    const cv::Mat1d since = patterns.row(k) - patterns.row(0);
    const auto noise_of = [&](int group) { return noise / std::pow(groups.root_weight(group, 0), 2); };
    const double variance = k == 0 ? 0 : since.dot(since) / freedom - noise_of(0) - noise_of(k);
    fit.seen_k.push_back(root_of(variance));
    fit.fitted_k.push_back(fit.change_k * f(k, 0) / f(f.rows - 1, 0));
  }
  return fit;
}

Result<void> check_groups(std::span<const DriftGroup> groups) {
  const auto wrong = [](const char* what) { return fail(ErrorCode::invalid_input, what); };
  if (groups.size() < least_drift_groups) return wrong("the fit of the drift needs at least eight groups of frames");
  constexpr int least_side = 4;
  const cv::Size size = groups.front().mean_k.size();
  if (size.width < least_side || size.height < least_side)
    return wrong("the fit of the drift needs at least 4 x 4 pixels");
  for (std::size_t k = 0; k < groups.size(); ++k) {
    if (groups[k].mean_k.size() != size) return wrong("the groups of frames have different sizes");
    if (!std::isfinite(groups[k].time_s) || !cv::checkRange(groups[k].mean_k))
      return wrong("a group of frames contains a value that is not finite");
    if (groups[k].frames < 1) return wrong("a group has no frames");
    if (k > 0 && !(groups[k].time_s > groups[k - 1].time_s))
      return wrong("the times of the groups of frames do not increase");
  }
  return {};
}

GroupTimes times_of(std::span<const DriftGroup> groups) {
  const auto count = static_cast<double>(groups.size());
  double frames = 0;
  for (const DriftGroup& group : groups) frames += group.frames / count;
  GroupTimes out{{}, Column(static_cast<int>(groups.size()), 1)};
  for (std::size_t k = 0; k < groups.size(); ++k) {
    out.time_s.push_back(groups[k].time_s);
    out.root_weight(static_cast<int>(k), 0) = std::sqrt(groups[k].frames / frames);
  }
  return out;
}

}  // namespace

std::string_view to_string(DriftShape shape) {
  return shape == DriftShape::approach ? "approach" : "linear";
}

double DriftLaw::per_minute(double change_k) const {
  return 60 * change_k / (time_s.back() - time_s.front());
}

Result<DriftLaw> drift_law(std::span<const DriftGroup> groups) {
  TODBENCH_TRY_VOID(check_groups(groups));
  DriftLaw law;
  const int count = static_cast<int>(groups.size());
  cv::Mat1d levels(count, 1), patterns(count, static_cast<int>(groups.front().mean_k.total()));
  for (int k = 0; k < count; ++k) {
    const DriftGroup& group = groups[static_cast<std::size_t>(k)];
    law.time_s.push_back(group.time_s);
    levels(k, 0) = cv::mean(group.mean_k)[0];
    const cv::Mat1d pattern = group.mean_k - levels(k, 0) - shading_of(group.mean_k).surface;
    pattern.reshape(1, 1).copyTo(patterns.row(k));
  }
  const GroupTimes times = times_of(groups);
  law.pattern = pattern_fit(times, patterns);
  law.level = level_fit(times, levels, law.pattern.change_k / std::sqrt(patterns.cols));
  return law;
}

}  // namespace todbench
