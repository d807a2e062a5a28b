// SPDX-License-Identifier: GPL-3.0-or-later
// Control charts of a measure of one unit: EWMA, CUSUM, their run lengths, and the time at which a trend crosses a
// limit.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace todbench {

/// Value of one check of a unit. For ratio scales (acuity) use the logarithm.
struct ChartValue {
  double days = 0;  ///< since any fixed origin
  double value = 0;
  double u = 0;  ///< standard uncertainty, without the part common to all checks
};

/// Parameters of the charts: EWMA (Roberts 1959) with time-varying limits (Lucas and Saccucci 1990), and CUSUM (Page
/// 1954).
struct ChartDesign {
  /// EWMA: average run length (ARL) 238 in control, 8.8 at a shift of one standard deviation.
  double lambda = 0.2, ewma_limit = 2.7;
  double cusum_k = 0.5, cusum_h = 5;  ///< CUSUM: ARL 465 in control, 10.4 at a shift of one standard deviation
  int reference_values = 3;           ///< number of first values, whose mean is the reference
  std::optional<double> reference{};  ///< known reference; replaces the mean of the first values
  std::optional<double> scatter{};    ///< known scatter; replaces the estimate
};

/// One check in the charts.
struct ChartPoint {
  double days = 0, value = 0, u = 0;
  double z = 0;  ///< standardised deviation from the reference
  double ewma = 0, ewma_limit = 0;
  double cusum_up = 0, cusum_down = 0;
  bool in_reference = false;
  bool signal = false;  ///< EWMA or CUSUM is beyond its limit
};

/// Charts of one measure.
struct ControlChart {
  double reference = 0, reference_u = 0;
  double scatter = 0;  ///< standard deviation of the true values between checks, in excess of their uncertainties
  std::vector<ChartPoint> points;
  [[nodiscard]] bool signalled() const { return !points.empty() && points.back().signal; }
};

/// Returns the chart of values in the order of time. The reference is the weighted mean of the first values. The
/// standard error of the reference widens the limits of the EWMA. If this error is 0, the limits are the usual limits.
/// The scatter is the square root of half the mean square of successive differences minus the mean u^2 (von Neumann
/// 1941), at least 0. Empty if there is no value after the reference, or if a value has neither uncertainty nor
/// scatter.
[[nodiscard]] std::optional<ControlChart> control_chart(const std::vector<ChartValue>& values,
                                                        const ChartDesign& design);

/// Return the average run length for a shift in standard deviations. This is the mean number of checks until a chart
/// with constant limits signals, starting from its neutral state. Solve the integral equation (EWMA: Crowder 1987;
/// CUSUM: Page 1954) by Gaussian quadrature with an error of 1e-8.
[[nodiscard]] double ewma_run_length(double lambda, double limit, double shift);
[[nodiscard]] double cusum_run_length(double k, double h, double shift);

/// Kind of a predicted crossing.
enum class CrossingKind {
  found,       ///< between `earliest_days` and `latest_days`
  not_before,  ///< `latest_days` is empty, because the slope is not significant
  never,       ///< the data exclude a future crossing
};
/// Returns the name of the enumerator.
[[nodiscard]] std::string_view to_string(CrossingKind kind);

/// Time at which a straight line through the values meets a limit.
struct LimitCrossing {
  CrossingKind kind = CrossingKind::never;
  double slope_per_year = 0, slope_u_per_year = 0;
  std::optional<double> best_days{}, earliest_days{}, latest_days{};
};

/// Fits x = a + b t (x: value, t: days) with weights 1 / (u^2 + scatter^2). The 95 % interval of the crossing (Fieller
/// 1954) contains all t after the last value with (a + b t - limit)^2 <= z^2 (1 / W + (t - tm)^2 var b). W is the sum
/// of the weights, tm the weighted mean of t, and z = 1.96. The function does not report that the last value is already
/// beyond the limit. Empty for fewer than three values or a single time.
[[nodiscard]] std::optional<LimitCrossing> crossing(const std::vector<ChartValue>& values, double scatter,
                                                    double limit);

}  // namespace todbench
