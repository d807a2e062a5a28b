// SPDX-License-Identifier: GPL-3.0-or-later
// Small plots: points with intervals, lines, bands. Equal plots give equal drawings.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/report/drawing.h"
#include "bench/report/plot_ticks.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Marker of the points of a series.
enum class PlotMarker { none, disc, square, bar };
/// Line through the points of a series.
enum class PlotLine { none, solid, dashed, dotted };

/// Point, or only its bounds. An interval with one open limit is drawn as an arrow to the edge of the plot. An interval
/// with two open limits is not drawn. A point without x or y has no marker and interrupts the line. The interval of
/// this point is drawn only if the other coordinate exists.
struct PlotPoint {
  std::optional<double> x, y;
  Interval x_interval, y_interval;
};

/// Points with a common appearance.
struct PlotSeries {
  std::string label;  ///< legend text; empty: not in the legend
  PlotTone tone = PlotTone::first;
  PlotMarker marker = PlotMarker::disc;
  PlotLine line = PlotLine::none;
  PlotLine legend_line = PlotLine::none;  ///< line in the legend only, if the line itself is a separate series
  std::vector<PlotPoint> points;
  double dodge_px = 0;  ///< shifts the series down to keep the intervals of two series apart
};

/// Range of x over the full height.
struct PlotBand {
  std::string label;
  PlotTone tone = PlotTone::first;
  Interval x;  ///< an open limit reaches the edge
};

/// Horizontal line with its name above its right end.
struct PlotReference {
  double y = 0;
  std::string label;
};

/// Content of a plot.
struct Plot {
  std::string id;                    ///< unique on the page; letters, digits, hyphens
  std::string title;                 ///< for screen readers
  std::string description;           ///< description of the visible content, for screen readers
  double width = 860, height = 410;  ///< user units; the picture scales with the page
  PlotAxis x, y;
  std::vector<PlotBand> bands;
  std::vector<PlotReference> references;
  /// Later series are drawn over earlier series and precede them in the legend.
  std::vector<PlotSeries> series;
};

/// Draws the plot with axes, ticks and legend. Errors: `invalid_input` (an axis that cannot be drawn).
[[nodiscard]] Result<Drawing> drawn(const Plot& plot);

}  // namespace todbench
