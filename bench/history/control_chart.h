// Control charts of a measure of one unit: EWMA, CUSUM, their run lengths, and
// when a line crosses a limit.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace todbench {

/// One check of a unit. Ratios, such as acuity, are charted by their logarithm.
struct ChartValue {
  double days = 0;  ///< since any moment
  double value = 0;
  double u = 0;  ///< standard, without what is common to all checks
};

/// EWMA after Roberts (1959) with limits that change in time (Lucas and
/// Saccucci 1990); CUSUM after Page (1954).
struct ChartDesign {
  double lambda = 0.2, ewma_limit = 2.7;  ///< ARL 238 in control, 8.8 at a shift
                                          ///< of one standard deviation
  double cusum_k = 0.5, cusum_h = 5;      ///< ARL 465 and 10.4
  int reference_values = 3;               ///< the first ones, whose mean is the reference
  std::optional<double> reference{};      ///< known beforehand, in place of theirs
  std::optional<double> scatter{};        ///< likewise
};

struct ChartPoint {
  double days = 0, value = 0, u = 0;
  double z = 0;  ///< standardised deviation from the reference
  double ewma = 0, ewma_limit = 0;
  double cusum_up = 0, cusum_down = 0;
  bool in_reference = false;
  bool signal = false;  ///< beyond a limit of either chart
};

struct ControlChart {
  double reference = 0, reference_u = 0;
  double scatter = 0;  ///< of the true values between checks, beyond their uncertainties
  std::vector<ChartPoint> points;
  [[nodiscard]] bool signalled() const { return !points.empty() && points.back().signal; }
};

/// Values in the order of time. Reference: weighted mean of the first ones; its
/// error is in the limits of the EWMA. Without an error of the reference the
/// limits are the usual ones. Scatter: half the mean square of successive
/// differences less the mean u^2 (von Neumann 1941), not below 0. Nothing with
/// fewer values than one more than the reference has, or where nothing is
/// uncertain.
[[nodiscard]] std::optional<ControlChart> control_chart(const std::vector<ChartValue>& values,
                                                        const ChartDesign& design);

/// Average run length of a chart with constant limits from its neutral state,
/// in checks, at a shift in standard deviations, to 1e-8: the integral equation
/// (Crowder 1987; Page 1954) by Gauss's quadrature.
[[nodiscard]] double ewma_run_length(double lambda, double limit, double shift);
[[nodiscard]] double cusum_run_length(double k, double h, double shift);

enum class CrossingKind {
  found,       ///< between `earliest` and `latest`
  not_before,  ///< the far end is open: the slope is not significant
  never,       ///< no crossing ahead is compatible with the data
};
[[nodiscard]] std::string_view to_string(CrossingKind kind);

/// When a straight line through the values meets a limit.
struct Crossing {
  CrossingKind kind = CrossingKind::never;
  double slope_per_year = 0, slope_u_per_year = 0;
  std::optional<double> best_days{}, earliest_days{}, latest_days{};
};

/// Weighted line x = a + b t; 95 % interval of the crossing after Fieller
/// (1954): all t with (a + b t - limit)^2 <= z^2 (1 / W + (t - tm)^2 var b).
/// Weights 1 / (u^2 + scatter^2). Only what lies after the last value counts; a
/// last value beyond the limit is the reader's to see. Nothing for fewer than
/// three values or one moment.
[[nodiscard]] std::optional<Crossing> crossing(const std::vector<ChartValue>& values, double scatter, double limit);

}  // namespace todbench
