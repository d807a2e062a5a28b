// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "bench/report/measure_figures.h"
#include "bench/report/plot.h"

namespace todbench {
namespace {

constexpr double milliseconds = 1000;
constexpr double shown_time_constants = 8;
constexpr double longest_s = 1e6, most_left = 10;  // limits for records that may have been edited

Figure figure_of(const StepResponse& curve, const std::string& id, const std::string& who) {
  Plot plot;
  plot.id = id, plot.title = "Response to steps, " + who;
  plot.description = "Remaining part of a step of the target over the time since the step, " + who +
                     ": frames after the first complete exposure, and the fitted first-order response";
  plot.width = 430, plot.height = 330;
  PlotSeries line{.label = "first-order fit",
                  .tone = PlotTone::second,
                  .marker = PlotMarker::none,
                  .line = PlotLine::solid,
                  .points = {}};
  PlotSeries rise{.label = "rise", .tone = PlotTone::first, .marker = PlotMarker::disc, .points = {}};
  PlotSeries fall{.label = "fall", .tone = PlotTone::first, .marker = PlotMarker::square, .points = {}};
  const double last_s = shown_time_constants * curve.both.value_s;
  double low = 0, high = 0.1;
  for (const StepPoint& point : curve.points) {
    if (!(point.time_s >= 0) || point.time_s > last_s || std::abs(point.left) > most_left) continue;
    (point.rising ? rise : fall)
        .points.push_back({.x = milliseconds * point.time_s, .y = point.left, .x_interval = {}, .y_interval = {}});
    low = std::min(low, point.left), high = std::max(high, point.left);
  }
  constexpr int parts = 80;
  for (int i = 0; i <= parts; ++i) {
    const double time_s = last_s * i / parts, left = std::exp(-time_s / curve.both.value_s);
    if (left <= 1.1 * high)
      line.points.push_back({.x = milliseconds * time_s, .y = left, .x_interval = {}, .y_interval = {}});
  }
  plot.x = {.label = "Time since the step (ms)", .low = 0, .high = milliseconds * last_s, .ticks = {}};
  plot.y = {.label = "Remaining part of the step", .low = low - 0.05 * (high - low), .high = 1.12 * high, .ticks = {}};
  for (PlotSeries* series : {&line, &rise, &fall})
    if (!series->points.empty()) plot.series.push_back(std::move(*series));
  return {drawn(plot), plot.description};
}

bool drawable(const StepResponse& response) {
  return response.both.value_s > 0 && response.both.value_s < longest_s && !response.points.empty();
}

bool drawable(const std::optional<MeasureLines>& side) {
  return side && side->response && drawable(side->response->response);
}

}  // namespace

std::optional<Figure> settling_figure(const StepResponse& response, const std::string& id, const std::string& who) {
  return drawable(response) ? std::optional(figure_of(response, id, who)) : std::nullopt;
}

std::optional<FigurePairs> response_figures(const SessionMeasures& measures, bool camera) {
  FigurePairs figures;
  if (drawable(measures.main)) {
    figures.figures.push_back(
        figure_of(measures.main->response->response, "response-main", camera ? "camera" : "simulated sensor"));
  }
  if (drawable(measures.twin))
    figures.figures.push_back(figure_of(measures.twin->response->response, "response-twin", "simulated twin"));
  if (figures.figures.empty()) return std::nullopt;
  return figures;
}

}  // namespace todbench
