// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/grid_figure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>

#include "bench/report/number_format.h"
#include "bench/report/report_pieces.h"

namespace todbench {
namespace {

struct GridLine {
  PlotTone tone;
  PlotMarker marker;
  PlotLine line;
};
constexpr std::array grid_lines{GridLine{PlotTone::first, PlotMarker::disc, PlotLine::solid},
                                GridLine{PlotTone::second, PlotMarker::square, PlotLine::dashed},
                                GridLine{PlotTone::third, PlotMarker::bar, PlotLine::dotted},
                                GridLine{PlotTone::muted, PlotMarker::disc, PlotLine::solid},
                                GridLine{PlotTone::first, PlotMarker::square, PlotLine::dashed},
                                GridLine{PlotTone::second, PlotMarker::bar, PlotLine::dotted}};

/// Returns the indices in the order of the values.
std::vector<std::size_t> order_of(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  return order;
}

/// Returns at most `most` of them, including the first and the last.
std::vector<std::size_t> spread_over(const std::vector<std::size_t>& all, std::size_t most) {
  if (all.size() <= most) return all;
  std::set<std::size_t> places;
  for (std::size_t i = 0; i < most; ++i) places.insert(i * (all.size() - 1) / (most - 1));
  std::vector<std::size_t> chosen;
  for (const std::size_t place : places) chosen.push_back(all[place]);
  return chosen;
}

}  // namespace

std::optional<Plot> grid_plot(const GridFigure& grid) {
  Plot plot;
  plot.id = "range-grid-" + grid.model;
  plot.title = "Range for 75 % against contrast, " + grid.model;
  plot.description = "Range for 75 % over the contrast of the target, one line for each size.";
  const auto contrasts = order_of(grid.contrasts_k);
  double near = 0, far = 0;
  std::size_t number = 0;
  auto sizes = spread_over(order_of(grid.sizes_m), grid_lines.size());
  std::reverse(sizes.begin(), sizes.end());
  for (const std::size_t s : sizes) {
    const GridLine& style = grid_lines[number++];
    PlotSeries series{.label = stated(grid.sizes_m[s]) + " m",
                      .tone = style.tone,
                      .marker = style.marker,
                      .line = style.line,
                      .points = {}};
    for (const std::size_t c : contrasts) {
      const auto& r75 = grid.r75_m[s * grid.contrasts_k.size() + c];
      series.points.push_back({.x = grid.contrasts_k[c], .y = r75, .x_interval = {}, .y_interval = {}});
      if (!r75) continue;
      near = near > 0 ? std::min(near, *r75) : *r75;
      far = std::max(far, *r75);
    }
    plot.series.push_back(std::move(series));
  }
  if (!(far > 0)) return std::nullopt;
  const double low = grid.contrasts_k[contrasts.front()], high = grid.contrasts_k[contrasts.back()];
  plot.x = {.label = "Contrast of the target (K)",
            .scale = AxisScale::logarithmic,
            .low = low / 1.1,
            .high = high * 1.1,
            .ticks = {}};
  plot.y = {.label = "Range for 75 % (m)",
            .scale = AxisScale::logarithmic,
            .low = near / 1.1,
            .high = far * 1.1,
            .ticks = {}};
  return plot;
}

Section grid_section(const std::vector<GridFigure>& grids) {
  Section section{"Other targets in the same atmosphere", {}};
  for (const GridFigure& grid : grids) {
    const auto plot = grid_plot(grid);
    if (!plot) {
      section.blocks.emplace_back(Paragraph{plain(grid.model + ": no target of the grid has a range.")});
      continue;
    }
    section.blocks.emplace_back(
        Figure{drawn(*plot), "Range for 75 % against contrast by " + grid.model +
                                 ", one line for each size. A line ends where the range is unknown."});
  }
  return section;
}

}  // namespace todbench
