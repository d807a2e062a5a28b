// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "bench/report/measure_figures.h"
#include "bench/report/plot.h"

namespace todbench {

std::optional<FigurePairs> absolute_figures(const SessionMeasures& measures, bool camera) {
  if (!measures.main || !measures.main->absolute) return std::nullopt;
  const AbsoluteMeasure& absolute = *measures.main->absolute;
  const std::string who = camera ? "camera" : "sensor";
  PlotSeries series{.label = who, .marker = PlotMarker::disc, .line = PlotLine::solid, .points = {}};
  double first_k = HUGE_VAL, last_k = -HUGE_VAL, farthest_k = 1e-6;
  for (const AbsoluteLevel& level : absolute.levels) {
    if (level.saturated || !std::isfinite(level.expected_k) || !std::isfinite(level.seen_k)) continue;
    const Estimate deviation = absolute.deviation_k(level);
    series.points.push_back(
        {.x = level.expected_k, .y = deviation.value, .x_interval = {}, .y_interval = deviation.interval()});
    first_k = std::min(first_k, level.expected_k), last_k = std::max(last_k, level.expected_k);
    farthest_k = std::max({farthest_k, std::abs(deviation.low), std::abs(deviation.high)});
  }
  if (series.points.empty()) return std::nullopt;
  Plot plot;
  plot.id = "absolute", plot.title = "Error of the absolute temperature";
  plot.description = "Temperature of the picture minus that of the black body against temperature, with 95 % intervals";
  plot.width = 560, plot.height = 330;
  const double margin_k = std::max(0.5, 0.05 * (last_k - first_k));
  plot.x = {
      .label = "Temperature of the black body (K)", .low = first_k - margin_k, .high = last_k + margin_k, .ticks = {}};
  plot.y = {.label = "Error of the " + who + " (K)", .low = -1.15 * farthest_k, .high = 1.15 * farthest_k, .ticks = {}};
  plot.references = {{0, "no error"}};
  plot.series.push_back(std::move(series));
  FigurePairs figures;
  figures.figures.push_back({drawn(plot),
                             "Error of the absolute temperature: mean of the picture minus the temperature that a "
                             "correct camera shows; 95 % intervals of repeatability and source"});
  return figures;
}

}  // namespace todbench
