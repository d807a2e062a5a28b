// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "bench/report/measure_figures.h"
#include "bench/report/plot.h"

namespace todbench {
namespace {

PlotSeries level_series(const GainControlMeasure& gain, const std::string& label, PlotTone tone, PlotMarker marker,
                        double (*value)(const GainLevel&)) {
  PlotSeries series{.label = label, .tone = tone, .marker = marker, .line = PlotLine::solid, .points = {}};
  std::vector<GainLevel> levels = gain.levels;
  std::ranges::sort(levels, {}, &GainLevel::said_delta_t_k);
  for (const GainLevel& level : levels)
    series.points.push_back({.x = level.said_delta_t_k, .y = value(level), .x_interval = {}, .y_interval = {}});
  return series;
}

Figure levels_figure(const GainControlMeasure& gain) {
  Plot plot;
  plot.id = "gain-levels", plot.title = "Levels of the automatic gain";
  plot.description = "Levels of the target and of its surround against the contrast of the target";
  plot.width = 430, plot.height = 330;
  plot.series.push_back(level_series(gain, "large triangles", PlotTone::first, PlotMarker::disc,
                                     [](const GainLevel& level) { return level.surround + level.contrast; }));
  plot.series.push_back(level_series(gain, "surround", PlotTone::second, PlotMarker::square,
                                     [](const GainLevel& level) { return level.surround; }));
  double low = HUGE_VAL, high = -HUGE_VAL, first_k = 0, last_k = 0;
  for (const PlotSeries& series : plot.series) {
    for (const PlotPoint& point : series.points) {
      low = std::min(low, *point.y), high = std::max(high, *point.y);
      first_k = std::min(first_k, *point.x), last_k = std::max(last_k, *point.x);
    }
  }
  const double margin = std::max(1e-6, 0.12 * (high - low)), side_k = std::max(1e-6, 0.06 * (last_k - first_k));
  plot.x = {.label = "Contrast of the target (K)", .low = first_k - side_k, .high = last_k + side_k, .ticks = {}};
  plot.y = {.label = "Level (" + gain.unit + ")", .low = low - margin, .high = high + 2 * margin, .ticks = {}};
  return {drawn(plot), "Levels of the picture against the contrast of the target, once the gain has settled"};
}

}  // namespace

std::optional<FigurePairs> gain_control_figures(const SessionMeasures& measures, bool /*camera*/) {
  if (!measures.main || !measures.main->gain_control) return std::nullopt;
  const GainControlMeasure& gain = *measures.main->gain_control;
  FigurePairs figures;
  if (std::ranges::all_of(gain.levels, [](const GainLevel& level) {
        return std::abs(level.surround) < 1e9 && std::abs(level.contrast) < 1e9 && std::abs(level.said_delta_t_k) < 1e9;
      }))
    figures.figures.push_back(levels_figure(gain));
  if (gain.settling) {
    if (auto figure = settling_figure(gain.settling->response, "gain-settling", "level round the target"))
      figures.figures.push_back(*std::move(figure));
  }
  if (figures.figures.empty()) return std::nullopt;
  return figures;
}

}  // namespace todbench
