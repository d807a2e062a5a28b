#include "bench/report/cost_figure.h"

#include <algorithm>

namespace todbench {
namespace {

constexpr double smallest_error_percent = 1e-3;

}  // namespace

Plot cost_plot(const std::vector<CostMark>& marks) {
  Plot plot;
  plot.id = "cost";
  plot.title = "What accuracy costs in time";
  plot.description = "Error of the 75 % acuity against the reference over wall time, for each knob and the planner.";
  PlotSeries optics{
      .label = "wavelengths, wrap, band", .tone = PlotTone::second, .marker = PlotMarker::square, .points = {}};
  PlotSeries sampling{.label = "phases, draws", .tone = PlotTone::third, .marker = PlotMarker::bar, .points = {}};
  PlotSeries planner{.label = "planner", .tone = PlotTone::muted, .marker = PlotMarker::disc, .points = {}};
  PlotSeries chosen{.label = "chosen", .tone = PlotTone::first, .marker = PlotMarker::disc, .points = {}};
  double fastest = marks.front().wall_s, slowest = fastest, largest = smallest_error_percent;
  for (const CostMark& mark : marks) {
    const double error = std::max(mark.error_percent, smallest_error_percent);
    fastest = std::min(fastest, mark.wall_s);
    slowest = std::max(slowest, mark.wall_s);
    largest = std::max(largest, error);
    PlotSeries& series = mark.chosen                                     ? chosen
                         : mark.knob == "planner"                        ? planner
                         : mark.knob == "phases" || mark.knob == "draws" ? sampling
                                                                         : optics;
    series.points.push_back({.x = mark.wall_s, .y = error, .x_interval = {}, .y_interval = {}});
  }
  plot.x = {.label = "Wall time (s)",
            .scale = AxisScale::logarithmic,
            .low = fastest / 1.5,
            .high = slowest * 1.5,
            .ticks = {}};
  plot.y = {.label = "Error of the 75 % acuity (%)",
            .scale = AxisScale::logarithmic,
            .low = smallest_error_percent / 1.5,
            .high = largest * 2,
            .ticks = {}};
  for (PlotSeries* series : {&optics, &sampling, &planner, &chosen}) {
    if (!series->points.empty()) plot.series.push_back(std::move(*series));
  }
  return plot;
}

}  // namespace todbench
