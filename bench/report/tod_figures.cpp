// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/tod_figures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "acquisition/base/distributions.h"
#include "acquisition/base/normal.h"
#include "bench/report/number_format.h"
#include "tod/psychometric/acuity.h"
#include "tod/psychometric/twin_shape.h"

namespace todbench {
namespace {

/// Range of the included values.
struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void include(std::optional<double> value) {
    if (!value || !std::isfinite(*value)) return;
    low = std::min(low, *value);
    high = std::max(high, *value);
  }
  [[nodiscard]] bool empty() const { return !(low <= high); }
};

/// Returns the effective contrast, or the set contrast if it was not measured.
double contrast_of(const TodPoint& point) {
  return point.delta_t_k != 0 ? point.delta_t_k : point.set_delta_t_k;
}

PlotPoint tod_point(const TodPoint& point) {
  return {stated_acuity_per_mrad(point.fit), std::abs(contrast_of(point)), acuity_interval(point.fit.ci95), {}};
}

/// Returns the points of one sign. A line joins neighbouring contrasts.
PlotSeries tod_series(const NamedCurve& curve, PlotTone tone, double sign) {
  PlotSeries series;
  const bool is_first = tone == PlotTone::first;
  series.label = curve.name + (sign < 0 ? ", ΔT < 0" : "");
  series.tone = tone;
  series.marker = is_first ? PlotMarker::disc : PlotMarker::square;
  series.line = is_first ? PlotLine::solid : PlotLine::dashed;
  if (sign < 0) series.line = PlotLine::dotted;
  series.dodge_px = is_first ? -3 : 3;
  for (const TodPoint& point : curve.curve->points)
    if (contrast_of(point) * sign > 0) series.points.push_back(tod_point(point));
  return series;
}

/// Adds the curve of a ramp with its 95 % band. The points then have no line of their own.
void add_continuous_curve(Plot& plot, const TodCurve& curve, PlotTone tone) {
  PlotSeries middle;
  middle.tone = tone, middle.marker = PlotMarker::none, middle.line = PlotLine::solid;
  PlotSeries low = middle, high = middle;
  low.line = high.line = PlotLine::dotted;
  for (const ContinuousPoint& point : curve.continuous) {
    const Interval acuity = acuity_interval(point.ci95);
    const double contrast = std::abs(point.delta_t_k);
    low.points.push_back({acuity.low, contrast, {}, {}});
    middle.points.push_back({1 / point.s75_mrad, contrast, {}, {}});
    high.points.push_back({acuity.high, contrast, {}, {}});
  }
  for (PlotSeries* series : {&low, &high, &middle}) plot.series.push_back(std::move(*series));
}

PlotSeries limit_series(std::span<const DrawnLimit> limits) {
  PlotSeries series;
  series.label = "limit (minimum acuity)";
  series.tone = PlotTone::muted;
  series.marker = PlotMarker::bar;
  for (const DrawnLimit& limit : limits)
    series.points.push_back({limit.least_acuity_per_mrad, std::abs(limit.delta_t_k), {}, {}});
  return series;
}

/// Sets the ends of an axis to contain `range` with a margin.
void set_logarithmic_range(PlotAxis& axis, const Range& range, double room) {
  axis.scale = AxisScale::logarithmic;
  axis.low = range.empty() ? 0.1 : range.low / room;
  axis.high = range.empty() ? 10 : range.high * room;
}

struct PsychometricLayer {
  PlotTone tone;
  PlotMarker marker;
  PlotLine line;
};

PlotSeries proportions(const NamedPoint& point, const PsychometricLayer& layer) {
  PlotSeries series;
  series.label = point.name;
  series.tone = layer.tone;
  series.marker = layer.marker;
  for (const AnswersAtSize& answers : answers_by_size(*point.point))
    if (answers.size_mrad > 0)
      series.points.push_back({answers.size_mrad, answers.correct / answers.total, {}, proportion_interval(answers)});
  return series;
}

PlotSeries fitted_curve(const PsychometricFit& fit, PsychometricForm form, const PlotAxis& sizes,
                        const PsychometricLayer& layer) {
  // 160 steps over an axis of about 350 px: chords stay within a tenth of a pixel of the curve.
  constexpr int steps = 160;
  PlotSeries series;
  series.tone = layer.tone;
  series.marker = PlotMarker::none;
  series.line = layer.line;
  if (!fit.threshold || !fit.slope || !(*fit.threshold > 0)) return series;
  std::optional<TwinShape> shape;
  if (fit.twin_shape) {
    if (auto made = TwinShape::of(fit.twin_shape->table)) shape = *std::move(made);
  }
  for (int i = 0; i <= steps; ++i) {
    const double size = sizes.low * std::pow(sizes.high / sizes.low, static_cast<double>(i) / steps);
    const double proportion = shape ? twin_proportion(*shape, *fit.twin_shape, fit.lapse, std::log(size))
                                    : psychometric(form, size, *fit.threshold, *fit.slope, fit.lapse);
    series.points.push_back({size, proportion, {}, {}});
  }
  return series;
}

void add_layer(Plot& plot, const NamedPoint& point, PsychometricForm form, const PsychometricLayer& layer) {
  if (point.point == nullptr) return;
  const PsychometricFit& fit = point.point->fit;
  if (fit.ci95.low || fit.ci95.high) plot.bands.push_back({"", layer.tone, fit.ci95});
  plot.series.push_back(fitted_curve(fit, form, plot.x, layer));
  if (point.point->lapse_warning && point.point->free_lapse_fit) {
    plot.series.push_back(fitted_curve(*point.point->free_lapse_fit, form, plot.x,
                                       {PlotTone::third, PlotMarker::none, PlotLine::dotted}));
    plot.series.back().label = point.name + ", free lapse";
  }
  PlotSeries points = proportions(point, layer);
  points.legend_line = fit.threshold && fit.slope ? layer.line : PlotLine::none;
  plot.series.push_back(std::move(points));
}

}  // namespace

std::vector<AnswersAtSize> answers_by_size(const TodPoint& point) {
  std::vector<Level> sorted = point.levels;
  std::stable_sort(sorted.begin(), sorted.end(), [](const Level& a, const Level& b) { return a.size < b.size; });
  std::vector<AnswersAtSize> answers;
  for (const Level& level : sorted) {
    if (!(level.total > 0)) continue;
    if (answers.empty() || level.size > answers.back().size_mrad * (1 + 1e-6))
      answers.push_back({.size_mrad = level.size});
    AnswersAtSize& sums = answers.back();
    sums.correct += level.correct;
    sums.total += level.total;
    sums.groups += 1;
    sums.squares += level.correct * level.correct;
    sums.products += level.correct * level.total;
    sums.total_squares += level.total * level.total;
    sums.graded = point.fit.dispersion.has_value();
  }
  return answers;
}

Interval wilson_interval(double correct, double total) {
  if (!(total > 0)) return {};
  constexpr double z = normal_z95;
  const double p = correct / total;
  const double middle = (p + z * z / (2 * total)) / (1 + z * z / total);
  const double half = z / (1 + z * z / total) * std::sqrt(p * (1 - p) / total + z * z / (4 * total * total));
  // The bounds at the ends are exactly 0 and 1; the formula misses them by rounding.
  return {correct > 0 ? std::max(0.0, middle - half) : 0.0, correct < total ? std::min(1.0, middle + half) : 1.0};
}

Interval proportion_interval(const AnswersAtSize& answers) {
  if (!answers.graded) return wilson_interval(answers.correct, answers.total);
  const double k = answers.groups, m = answers.correct / answers.total;
  if (!(k > 1)) return {};
  const double sum = answers.squares - 2 * m * answers.products + m * m * answers.total_squares;
  const double s = std::sqrt(std::max(0.0, sum) * k / (k - 1)) / answers.total;
  const double half = quantile(distribution::StudentsT(k - 1), 0.975) * s;
  return {std::max(0.0, m - half), std::min(1.0, m + half)};
}

Plot tod_figure(const NamedCurve& first, const NamedCurve& second, std::span<const DrawnLimit> limits) {
  Plot plot;
  plot.id = "tod";
  plot.title = "TOD curve";
  plot.description =
      "Acuity, the reciprocal of the 75 percent size, on a linear axis against contrast on a logarithmic axis. "
      "Horizontal bars are 95 percent intervals. The numbers are in the table below.";
  plot.x.label = "Acuity 1/S₇₅ (1/mrad)";
  plot.y.label = "Contrast |ΔT| (K)";
  if (!limits.empty()) plot.series.push_back(limit_series(limits));
  for (const auto& [curve, tone] : {std::pair{&second, PlotTone::second}, std::pair{&first, PlotTone::first}}) {
    if (curve->curve == nullptr) continue;
    const bool continuous = !curve->curve->continuous.empty();
    if (continuous) add_continuous_curve(plot, *curve->curve, tone);
    for (const double sign : {-1.0, 1.0}) {
      PlotSeries series = tod_series(*curve, tone, sign);
      if (continuous) series.legend_line = std::exchange(series.line, PlotLine::none);
      if (!series.points.empty()) plot.series.push_back(std::move(series));
    }
  }
  Range acuities;
  Range contrasts;
  for (const PlotSeries& series : plot.series) {
    for (const PlotPoint& point : series.points) {
      contrasts.include(point.y);
      acuities.include(point.x);
      acuities.include(point.x_interval.low);
      acuities.include(point.x_interval.high);
    }
  }
  plot.x.high = acuities.empty() ? 1 : acuities.high * 1.12;
  set_logarithmic_range(plot.y, contrasts, 1.8);
  return plot;
}

Plot with_acuity_axis(Plot plot, AxisScale scale) {
  plot.x.scale = scale;
  plot.x.low = 0;
  if (scale == AxisScale::linear) {
    // A very long interval must not compress the other points.
    Range points;
    for (const PlotSeries& series : plot.series)
      for (const PlotPoint& point : series.points) points.include(point.x);
    if (!points.empty()) plot.x.high = std::min(plot.x.high, 2.5 * points.high);
    return plot;
  }
  Range acuities;
  for (const PlotSeries& series : plot.series) {
    for (const PlotPoint& point : series.points) {
      acuities.include(point.x);
      acuities.include(point.x_interval.low);
      acuities.include(point.x_interval.high);
    }
  }
  set_logarithmic_range(plot.x, acuities, 1.25);
  return plot;
}

Plot psychometric_figure(const std::string& id, const NamedPoint& first, const NamedPoint& second,
                         PsychometricForm form, std::span<const double> expected_sizes_mrad) {
  Plot plot;
  plot.id = id;
  plot.width = 460;
  plot.height = 344;
  Range sizes;
  for (const double size : expected_sizes_mrad) sizes.include(size);
  for (const NamedPoint* point : {&first, &second}) {
    if (point->point == nullptr) continue;
    for (const AnswersAtSize& answers : answers_by_size(*point->point))
      if (answers.size_mrad > 0) sizes.include(answers.size_mrad);
    if (point->point->fit.verdict == FitVerdict::extrapolated) sizes.include(stated_threshold(point->point->fit));
  }
  plot.x.label = "Size S (mrad)";
  set_logarithmic_range(plot.x, sizes, 1.12);
  plot.y = {"Proportion correct", AxisScale::linear, 0, 1.04, {0, 0.25, 0.5, 0.75, 1}};
  plot.references = {{0.75, "75 %"}, {0.25, "25 % (chance)"}};
  add_layer(plot, second, form, {PlotTone::second, PlotMarker::square, PlotLine::dashed});
  add_layer(plot, first, form, {PlotTone::first, PlotMarker::disc, PlotLine::solid});
  const TodPoint* named = first.point != nullptr ? first.point : second.point;
  if (named != nullptr)
    plot.title = "Psychometric function at a set contrast of " + stated(named->set_delta_t_k) + " K";
  plot.description =
      "Proportion of correct answers against triangle size, with the fitted function and the 95 percent interval of "
      "the 75 percent size. The numbers are in the appendix.";
  return plot;
}

}  // namespace todbench
