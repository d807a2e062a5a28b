// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "bench/report/measure_figures.h"
#include "bench/report/plot.h"

namespace todbench {
namespace {

constexpr int bins = 16;

/// Outline of a histogram of finite values over this range.
PlotSeries outline_of(const std::vector<double>& values, double low, double high) {
  std::vector<double> counts(bins, 0.0);
  for (const double value : values)
    counts[static_cast<std::size_t>(std::clamp((value - low) / (high - low) * bins, 0.0, bins - 1.0))] += 1;
  PlotSeries series{.label = "frames", .marker = PlotMarker::none, .line = PlotLine::solid, .points = {}};
  const auto add = [&](double x, double y) {
    series.points.push_back({.x = x, .y = y, .x_interval = {}, .y_interval = {}});
  };
  add(low, 0);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double width = (high - low) / bins, left = low + width * static_cast<double>(i);
    add(left, counts[i]), add(left + width, counts[i]);
  }
  add(high, 0);
  return series;
}

}  // namespace

std::optional<FigurePairs> latency_figures(const SessionMeasures& measures, bool camera) {
  if (!measures.main || !measures.main->latency) return std::nullopt;
  std::vector<double> lags_ms = measures.main->latency->frames_ms;
  std::erase_if(lags_ms, [](double lag) { return !(std::abs(lag) < 1e9); });
  if (lags_ms.empty()) return std::nullopt;
  const auto [least, most] = std::ranges::minmax_element(lags_ms);
  const double margin_ms = std::max(0.01, 0.02 * (*most - *least));
  const double low = *least - margin_ms, high = *most + margin_ms;
  Plot plot;
  plot.id = "latency", plot.title = "Latency of the frames";
  plot.description = "Histogram of the latencies of the frames of all runs, with the mean and its 95 % interval";
  plot.width = 560, plot.height = 330;
  PlotSeries outline = outline_of(lags_ms, low, high);
  double tallest = 1;
  for (const PlotPoint& point : outline.points) tallest = std::max(tallest, point.y.value_or(0));
  const Estimate& mean = measures.main->latency->latency_ms;
  plot.x = {.label = "Latency of a frame (ms)", .low = low, .high = high, .ticks = {}};
  plot.y = {.label = "Frames", .low = 0, .high = 1.2 * tallest, .ticks = {}};
  plot.series.push_back(std::move(outline));
  if (mean.value > low && mean.value < high)
    plot.series.push_back({.label = "mean of the runs, 95 %",
                           .tone = PlotTone::second,
                           .marker = PlotMarker::disc,
                           .points = {{.x = mean.value,
                                       .y = 1.1 * tallest,
                                       .x_interval = {std::max(low, mean.low), std::min(high, mean.high)},
                                       .y_interval = {}}}});
  FigurePairs figures;
  figures.figures.push_back({drawn(plot), "Latency of the frames of the " + std::string(camera ? "camera" : "sensor") +
                                              " in all runs of the stage: time from a place of the plate to the time "
                                              "stamp of the frame that shows it"});
  return figures;
}

}  // namespace todbench
