// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "bench/report/measure_figures.h"
#include "bench/report/plot.h"

namespace todbench {
namespace {

constexpr double millikelvin = 1000;

struct DriftWords {
  std::string id, title, axis, caption;
};

/// Observed points minus `zero_k`, and the fitted line.
Figure drift_figure(const DriftLaw& law, const DriftFit& fit, double zero_k, const DriftWords& words) {
  Plot plot;
  plot.id = words.id, plot.title = words.title, plot.description = words.caption;
  plot.width = 430, plot.height = 330;
  PlotSeries line{.label = fit.shape == DriftShape::linear ? "linear" : "exponential approach",
                  .tone = PlotTone::second,
                  .marker = PlotMarker::none,
                  .line = PlotLine::solid,
                  .points = {}};
  PlotSeries seen{.label = "camera", .tone = PlotTone::first, .marker = PlotMarker::disc, .points = {}};
  double low = 0, high = 0;
  for (std::size_t k = 0; k < law.time_s.size(); ++k) {
    const double fitted = millikelvin * (fit.fitted_k[k] - zero_k), point = millikelvin * (fit.seen_k[k] - zero_k);
    line.points.push_back({.x = law.time_s[k], .y = fitted, .x_interval = {}, .y_interval = {}});
    seen.points.push_back({.x = law.time_s[k], .y = point, .x_interval = {}, .y_interval = {}});
    low = std::min({low, fitted, point}), high = std::max({high, fitted, point});
  }
  const double room = 0.08 * std::max(high - low, 1e-3);
  plot.x = {.label = "Time since the correction (s)", .low = 0, .high = 1.05 * law.time_s.back(), .ticks = {}};
  plot.y = {.label = words.axis, .low = low < 0 ? low - room : 0, .high = high + room, .ticks = {}};
  plot.series.push_back(std::move(line));
  plot.series.push_back(std::move(seen));
  return {drawn(plot), words.caption};
}

}  // namespace

std::optional<FigurePairs> drift_figures(const SessionMeasures& measures, bool /*camera*/) {
  if (!measures.main || !measures.main->drift) return std::nullopt;
  const DriftLaw& law = measures.main->drift->law;
  FigurePairs figures;
  figures.figures.push_back(
      drift_figure(law, law.level, law.level.fitted_k.front(),
                   {"drift-level", "Drift of the mean", "Mean (mK)",
                    "Mean of the flat field after a correction, relative to the first value of the fit"}));
  figures.figures.push_back(drift_figure(law, law.pattern, 0,
                                         {"drift-pattern", "Growth of the spatial noise", "Spatial noise (mK)",
                                          "Standard deviation over the pixels of their change since the first group of "
                                          "frames, without white noise, mean and shading"}));
  return figures;
}

}  // namespace todbench
