// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "acquisition/base/normal.h"
#include "bench/report/measure_figures.h"
#include "bench/report/plot.h"

namespace todbench {
namespace {

constexpr double millikelvin_of_transfer = 1000;

/// Side drawn in front, or the twin behind it.
struct TransferSide {
  const TransferMeasure* measure = nullptr;
  std::string label;
  bool first = true;

  [[nodiscard]] PlotTone tone() const { return first ? PlotTone::first : PlotTone::second; }
  [[nodiscard]] PlotMarker marker() const { return first ? PlotMarker::disc : PlotMarker::square; }
};

std::vector<TransferSide> transfer_sides(const SessionMeasures& measures, bool camera) {
  std::vector<TransferSide> sides;
  const auto with_steps = [](const std::optional<MeasureLines>& side) {
    return side && side->transfer && !side->transfer->steps.empty();
  };
  const bool main = with_steps(measures.main);
  if (with_steps(measures.twin)) sides.push_back({&*measures.twin->transfer, "simulated twin", !main});
  if (main) sides.push_back({&*measures.main->transfer, camera ? "camera" : "simulated sensor", true});
  return sides;
}

/// Returns the range of the shown contrasts with a margin, on both sides of 0 if both polarities were shown.
Interval shown_range(const std::vector<TransferSide>& sides) {
  double low = 0, high = 0;
  for (const TransferSide& side : sides) {
    for (const TransferStep& step : side.measure->steps)
      low = std::min(low, step.said_delta_t_k), high = std::max(high, step.said_delta_t_k);
  }
  const double room = 0.06 * std::max(high - low, 1e-6);
  return {.low = low - room, .high = high + room};
}

/// Returns at least four ticks on an axis of this range, on both sides of 0.
std::vector<double> contrast_ticks(const Interval& range) {
  constexpr double fewest = 4;
  const double span = *range.high - *range.low;
  double step = std::pow(10, std::floor(std::log10(span)));
  for (const double part : {1.0, 0.5, 0.2, 0.1}) {
    if (span / (part * step) < fewest) continue;
    step *= part;
    break;
  }
  std::vector<double> ticks;
  for (double k = std::ceil(*range.low / step); k * step <= *range.high; ++k) ticks.push_back(k * step);
  return ticks;
}

Figure transfer_figure(const std::vector<TransferSide>& sides) {
  Plot plot;
  plot.id = "transfer", plot.title = "Signal transfer (SiTF)";
  plot.description = "Contrast observed in the camera's temperature scale over the contrast that the target reports";
  plot.width = 430, plot.height = 380;
  const Interval range = shown_range(sides);
  plot.x = {.label = "Shown contrast (K)", .low = *range.low, .high = *range.high, .ticks = contrast_ticks(range)};
  double low = *range.low, high = *range.high;
  plot.series.push_back({.label = "correct scale",
                         .tone = PlotTone::muted,
                         .marker = PlotMarker::none,
                         .line = PlotLine::dotted,
                         .points = {{.x = low, .y = low, .x_interval = {}, .y_interval = {}},
                                    {.x = high, .y = high, .x_interval = {}, .y_interval = {}}}});
  for (const TransferSide& side : sides) {
    PlotSeries line{.label = "",
                    .tone = side.tone(),
                    .marker = PlotMarker::none,
                    .line = side.first ? PlotLine::solid : PlotLine::dashed,
                    .points = {}};
    for (const double shown : {*range.low, *range.high}) {
      const double seen = side.measure->line.offset + side.measure->line.slope * shown;
      line.points.push_back({.x = shown, .y = seen, .x_interval = {}, .y_interval = {}});
      low = std::min(low, seen), high = std::max(high, seen);
    }
    PlotSeries steps{
        .label = side.label, .tone = side.tone(), .marker = side.marker(), .legend_line = line.line, .points = {}};
    for (const TransferStep& step : side.measure->steps) {
      steps.points.push_back({.x = step.said_delta_t_k, .y = step.seen_delta_t_k, .x_interval = {}, .y_interval = {}});
      low = std::min(low, step.seen_delta_t_k), high = std::max(high, step.seen_delta_t_k);
    }
    plot.series.push_back(std::move(line)), plot.series.push_back(std::move(steps));
  }
  plot.y = {.label = "Observed contrast (K)", .low = low, .high = high, .ticks = {}};
  return {drawn(plot),
          "Signal transfer (SiTF): observed contrast over the contrast that the target reports, with the least-squares "
          "line; dotted: correct temperature scale"};
}

Figure residual_figure(const std::vector<TransferSide>& sides) {
  Plot plot;
  plot.id = "transfer-residuals", plot.title = "Signal transfer (SiTF): residuals";
  plot.description = "Residual of each step from the least-squares line, with 95 % intervals";
  plot.width = 430, plot.height = 380;
  const Interval range = shown_range(sides);
  plot.x = {.label = "Shown contrast (K)", .low = *range.low, .high = *range.high, .ticks = contrast_ticks(range)};
  plot.references = {{0, ""}};
  double reach = 1e-3;
  for (const TransferSide& side : sides) {
    PlotSeries left{.label = side.label, .tone = side.tone(), .marker = side.marker(), .points = {}, .dodge_px = 0};
    for (const TransferStep& step : side.measure->steps) {
      const double fitted = side.measure->line.offset + side.measure->line.slope * step.said_delta_t_k;
      const double residual = millikelvin_of_transfer * (step.seen_delta_t_k - fitted);
      const double half = millikelvin_of_transfer * normal_z95 * step.seen_u_k;
      left.points.push_back({.x = step.said_delta_t_k,
                             .y = residual,
                             .x_interval = {},
                             .y_interval = {.low = residual - half, .high = residual + half}});
      reach = std::max(reach, 1.1 * (std::abs(residual) + half));
    }
    plot.series.push_back(std::move(left));
  }
  plot.y = {.label = "Observed minus line (mK)", .low = -reach, .high = reach, .ticks = {}};
  return {drawn(plot),
          "Residual of each step from the least-squares line, with 95 % intervals from the scatter over the triangles"};
}

}  // namespace

std::optional<FigurePairs> transfer_figures(const SessionMeasures& measures, bool camera) {
  const std::vector<TransferSide> sides = transfer_sides(measures, camera);
  if (sides.empty()) return std::nullopt;
  return FigurePairs{{transfer_figure(sides), residual_figure(sides)}};
}

}  // namespace todbench
