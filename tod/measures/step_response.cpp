// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/step_response.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <numeric>
#include <string>

#include "acquisition/base/distributions.h"
#include "acquisition/base/mean.h"
#include "acquisition/base/median.h"
#include "acquisition/base/try.h"

namespace todbench {
namespace {

constexpr double seen_sigmas = 6, seen_part = 0.002;  // a sample shows the step: times the noise, part of the step
constexpr std::size_t least_fitted = 6;               // samples of a step
constexpr double shortest_over_frame = 0.12;          // in frames: exp(-8) remains after one
constexpr double longest_over_watch = 0.4;            // of the recorded time after a step
constexpr double first_order_level = 1e-4, detected_level = 1e-6;
constexpr double least_left = 2 * settling_left;  // of the step, after the settling time of a target

/// The fitted samples of one step; times from the first of them on.
struct FittedStep {
  bool rising = true;
  double size = 0;  ///< from the level before to that after
  std::vector<double> time_s, signal;
};

/// Least squares of a + g exp(-t / T), and its residuals.
struct StepLine {
  double level = 0, gap = 0, left = 0;
};

StepLine step_line(const FittedStep& step, double time_constant_s) {
  double mean_e = 0, mean_y = 0;
  const auto n = static_cast<double>(step.time_s.size());
  for (std::size_t k = 0; k < step.time_s.size(); ++k)
    mean_e += std::exp(-step.time_s[k] / time_constant_s) / n, mean_y += step.signal[k] / n;
  double ee = 0, ey = 0, yy = 0;
  for (std::size_t k = 0; k < step.time_s.size(); ++k) {
    const double e = std::exp(-step.time_s[k] / time_constant_s) - mean_e, y = step.signal[k] - mean_y;
    ee += e * e, ey += e * y, yy += y * y;
  }
  const double gap = ee > 0 ? ey / ee : 0;
  return {mean_y - gap * mean_e, gap, std::max(0.0, yy - gap * ey)};
}

double left_by(std::span<const FittedStep> steps, double time_constant_s) {
  double left = 0;
  for (const FittedStep& step : steps) left += step_line(step, time_constant_s).left;
  return left;
}

double freedom_of(std::span<const FittedStep> steps) {
  double freedom = -1;
  for (const FittedStep& step : steps) freedom += static_cast<double>(step.time_s.size()) - 2;
  return freedom;
}

/// Search range of the logarithms of time constants.
struct LogRange {
  double low = 0, high = 0;
};

LogRange range_of(std::span<const FittedStep> steps, double frame_s) {
  double span_s = steps.front().time_s.back();
  for (const FittedStep& step : steps) span_s = std::min(span_s, step.time_s.back());
  return {std::log(shortest_over_frame * frame_s), std::log(longest_over_watch * span_s)};
}

/// Logarithm of the time constant of the smallest sum of squares between two logarithms, by Brent's method (1973).
double least_between(std::span<const FittedStep> steps, double low, double high) {
  constexpr int minimum_bits = 26;
  const auto left = [&](double log_s) { return left_by(steps, std::exp(log_s)); };
  return boost::math::tools::brent_find_minima(left, low, high, minimum_bits).first;
}

constexpr int grid = 60;

/// Logarithm of the time constant of the smallest sum of squares.
double best_log(std::span<const FittedStep> steps, LogRange range) {
  const double step = (range.high - range.low) / grid;
  double best = range.low, least = left_by(steps, std::exp(best));
  for (int i = 1; i <= grid; ++i) {
    const double left = left_by(steps, std::exp(range.low + i * step));
    if (left < least) best = range.low + i * step, least = left;
  }
  return least_between(steps, std::max(range.low, best - step), std::min(range.high, best + step));
}

/// Limit of the range in which the sum of squares exceeds the least by chance only (F); empty: outside the range.
std::optional<double> profile_side(std::span<const FittedStep> steps, double best, double end) {
  const double freedom = freedom_of(steps), least = left_by(steps, std::exp(best));
  const double bound = least * (1 + quantile(distribution::FisherF(1, freedom), 0.95) / freedom);
  if (left_by(steps, std::exp(end)) <= bound) return std::nullopt;
  double inside = best, outside = end;
  while (std::abs(outside - inside) > 1e-6)
    (left_by(steps, std::exp(0.5 * (inside + outside))) <= bound ? inside : outside) = 0.5 * (inside + outside);
  return inside;
}

/// Half of the 95 % interval of the logarithm, from fits that leave one step out.
double jackknife_half(std::span<const FittedStep> steps, double best, LogRange range) {
  constexpr double near = 0.7;
  std::vector<double> logs;
  for (std::size_t out = 0; out < steps.size(); ++out) {
    std::vector<FittedStep> others;
    for (std::size_t i = 0; i < steps.size(); ++i)
      if (i != out) others.push_back(steps[i]);
    logs.push_back(least_between(others, std::max(range.low, best - near), std::min(range.high, best + near)));
  }
  const auto n = static_cast<double>(logs.size());
  const double mean = std::accumulate(logs.begin(), logs.end(), 0.0) / n;
  double squares = 0;
  for (const double log : logs) squares += (log - mean) * (log - mean);
  return quantile(distribution::StudentsT(n - 1), 0.975) * std::sqrt((n - 1) / n * squares);
}

Error not_told(std::string sentence) {
  return {ErrorCode::calibration, std::move(sentence)};
}

/// Change of the time constant if the first samples have `settling_left` of the step less.
double moved_by_settling(std::span<const FittedStep> steps, double best, LogRange range) {
  std::vector<FittedStep> without(steps.begin(), steps.end());
  for (FittedStep& step : without) step.signal.front() += settling_left * step.size;
  return std::abs(best_log(without, range) - best);
}

Result<StepTimeConstant> time_constant_of(std::span<const FittedStep> steps, const StepResponseOptions& options) {
  const LogRange range = range_of(steps, options.frame_s);
  const double freedom = freedom_of(steps);
  if (!(range.high > range.low) || freedom < 2)
    return tl::unexpected(Error{ErrorCode::invalid_input, "too few frames were recorded after a step"});
  const double best = best_log(steps, range);
  const double left = left_by(steps, std::exp(best));
  double still = 0;
  for (const FittedStep& step : steps) still += step_line(step, 1e-3 * options.frame_s).left;
  const auto more = static_cast<double>(steps.size()) + 1;
  const double f = (still - left) / more / (left / freedom);
  if (!(f > 0) || cdf(complement(distribution::FisherF(more, freedom), f)) > detected_level)
    return tl::unexpected(not_told(
        fmt::format("the response to a step has ended {}: the camera's time constant is too short to measure with "
                    "frames of {:.3g} ms",
                    options.settling_s > 0 ? "within the settling time of the target" : "within its first frame",
                    1e3 * options.frame_s)));
  const double cell = (range.high - range.low) / grid;
  if (best > range.high - cell)
    return tl::unexpected(
        not_told("the response to a step lasts longer than the recording: record more frames after each step"));
  const auto low = profile_side(steps, best, range.low), high = profile_side(steps, best, range.high);
  if (!low || !high) {
    return tl::unexpected(
        not_told(fmt::format("the steps give no {} limit of the time constant", low ? "upper" : "lower")));
  }
  const double half = jackknife_half(steps, best, range);
  const double settling = options.settling_s > 0 ? moved_by_settling(steps, best, range) : 0;
  return StepTimeConstant{.value_s = std::exp(best),
                          .low_s = std::exp(std::min(*low, best - half) - settling),
                          .high_s = std::exp(std::max(*high, best + half) + settling),
                          .steps = static_cast<int>(steps.size())};
}

/// F test of an additional term, (t / T)^2 exp(-t / T) in proportion to each amplitude, with levels, amplitudes and T.
double p_of_first_order(std::span<const FittedStep> steps, double time_constant_s) {
  // Residuals and the terms of T and of the second order, each without its projection on level and amplitude.
  double tt = 0, ts = 0, ss = 0, rt = 0, rs = 0, rr = 0;
  for (const FittedStep& step : steps) {
    const StepLine line = step_line(step, time_constant_s);
    FittedStep first = step, second = step;
    for (std::size_t k = 0; k < step.time_s.size(); ++k) {
      const double u = step.time_s[k] / time_constant_s, e = line.gap * std::exp(-u);
      first.signal[k] = u * e, second.signal[k] = u * u * e;
    }
    const StepLine of_first = step_line(first, time_constant_s), of_second = step_line(second, time_constant_s);
    for (std::size_t k = 0; k < step.time_s.size(); ++k) {
      const double e = std::exp(-step.time_s[k] / time_constant_s);
      const double r = step.signal[k] - line.level - line.gap * e;
      const double t = first.signal[k] - of_first.level - of_first.gap * e;
      const double s = second.signal[k] - of_second.level - of_second.gap * e;
      tt += t * t, ts += t * s, ss += s * s, rt += r * t, rs += r * s, rr += r * r;
    }
  }
  if (!(tt > 0)) return 1;
  const double across = ss - ts * ts / tt, along = rs - ts * rt / tt, freedom = freedom_of(steps) - 1;
  if (!(across > 1e-9 * ss) || freedom < 1) return 1;
  const double explained = along * along / across, left = rr - rt * rt / tt - explained;
  if (!(left > 0)) return 1;
  return cdf(complement(distribution::FisherF(1, freedom), explained / (left / freedom)));
}

double noise_before(std::span<const StepSeries> steps) {
  double squares = 0, freedom = 0;
  for (const StepSeries& step : steps) {
    const std::span<const double> before(step.signal.data(), step.before);
    const double mean = arithmetic_mean(before);
    for (const double value : before) squares += (value - mean) * (value - mean);
    freedom += static_cast<double>(step.before) - 1;
  }
  return std::sqrt(squares / freedom);
}

bool usable(const StepSeries& step) {
  if (step.signal.size() != step.time_s.size() || step.before < 2 || step.signal.size() < step.before + least_fitted)
    return false;
  for (std::size_t k = 0; k < step.signal.size(); ++k) {
    if (!std::isfinite(step.signal[k]) || !std::isfinite(step.time_s[k])) return false;
    if (k > 0 && !(step.time_s[k] > step.time_s[k - 1])) return false;
  }
  return true;
}

/// The part from the first frame on whose exposure began after the end of the step.
Result<FittedStep> fitted_part(const StepSeries& step, double noise, const StepResponseOptions& options) {
  const std::span<const double> all(step.signal);
  const double before = arithmetic_mean(all.first(step.before));
  const double after = arithmetic_mean(all.last(std::max<std::size_t>(2, (all.size() - step.before) / 4)));
  const double size = after - before, least = std::max(seen_sigmas * noise, seen_part * std::abs(size));
  if (!(std::abs(size) > 2 * least) || (size > 0) != step.rising)
    return tl::unexpected(not_told("a step of the target does not stand out from the noise of the picture"));
  const auto shows = [&](std::size_t k) { return std::abs(step.signal[k] - before) > least; };
  std::size_t first = 0;
  while (first < all.size() && !(shows(first) && (first + 1 == all.size() || shows(first + 1)))) ++first;
  if (first < step.before) return tl::unexpected(not_told("the target changed before its command"));
  constexpr double clock_jitter = 0.02;  // of a frame
  const double from_s = step.time_s[first] + options.settling_s + (1 - clock_jitter) * options.frame_s;
  FittedStep fitted{.rising = step.rising, .size = size, .time_s = {}, .signal = {}};
  for (std::size_t k = first; k < all.size(); ++k) {
    if (step.time_s[k] < from_s) continue;
    fitted.time_s.push_back(step.time_s[k]), fitted.signal.push_back(step.signal[k]);
  }
  if (fitted.time_s.size() < least_fitted)
    return tl::unexpected(not_told(
        fmt::format("too few frames remain after a step and the settling of the target ({})", fitted.time_s.size())));
  const double zero_s = fitted.time_s.front();
  for (double& time : fitted.time_s) time -= zero_s;
  return fitted;
}

void tell_points(StepResponse& response, std::span<const FittedStep> steps) {
  std::vector<double> left;
  for (const FittedStep& step : steps) {
    const StepLine line = step_line(step, response.both.value_s);
    const double part = -line.gap / step.size;  // of the step, at the first sample
    left.push_back(part);
    response.samples += static_cast<int>(step.time_s.size());
    if (!(part > 0)) continue;
    const double after_s = -response.both.value_s * std::log(part);
    for (std::size_t k = 0; k < step.time_s.size(); ++k) {
      response.points.push_back({.time_s = step.time_s[k] + after_s,
                                 .left = (line.level - step.signal[k]) / step.size,
                                 .rising = step.rising});
    }
  }
  response.largest_left = median(std::move(left));
}

}  // namespace

Result<StepResponse> step_response(std::span<const StepSeries> steps, const StepResponseOptions& options) {
  if (steps.size() < least_steps)
    return fail(ErrorCode::invalid_input, fmt::format("{} steps are too few for a time constant", steps.size()));
  if (!(options.frame_s > 0) || !(options.settling_s >= 0) || !std::all_of(steps.begin(), steps.end(), usable))
    return fail(ErrorCode::invalid_input, "the frames around a step are too few or not in order");
  const double noise = noise_before(steps);
  std::vector<FittedStep> fitted;
  for (const StepSeries& step : steps) {
    TODBENCH_TRY(auto part, fitted_part(step, noise, options));
    fitted.push_back(std::move(part));
  }
  TODBENCH_TRY(const auto both, time_constant_of(fitted, options));
  StepResponse response{.both = both, .points = {}};
  tell_points(response, fitted);
  if (options.settling_s > 0 && !(response.largest_left > least_left))
    return tl::unexpected(not_told(fmt::format(
        "the settling time of the target, {:.3g} ms, hides the response: only {:.2g} of a step remains after it",
        1e3 * options.settling_s, std::max(0.0, response.largest_left))));
  response.p_first_order = p_of_first_order(fitted, both.value_s);
  if (response.p_first_order < first_order_level)
    return tl::unexpected(
        not_told("the response is not of first order: the camera filters its frames, or the target settles more slowly "
                 "than stated"));
  for (const bool rising : {true, false}) {
    std::vector<FittedStep> some;
    for (const FittedStep& step : fitted)
      if (step.rising == rising) some.push_back(step);
    if (some.size() < least_steps) continue;
    if (const auto one = time_constant_of(some, options)) (rising ? response.rise : response.fall) = *one;
  }
  return response;
}

}  // namespace todbench
