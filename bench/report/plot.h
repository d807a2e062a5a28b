// Small plots: points with intervals, lines, bands. A value in, a drawing out; the same value gives the same drawing.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "acquisition/core/result.h"
#include "bench/report/drawing.h"
#include "bench/report/plot_ticks.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

enum class PlotMarker { none, disc, square, bar };
enum class PlotLine { none, solid, dashed, dotted };

/// A point, or only what bounds it. An interval with one side open is drawn as an arrow to the edge of the plot; with
/// both sides open it is not drawn. A point without x or y has no marker and interrupts the line; its interval needs
/// the other coordinate.
struct PlotPoint {
  std::optional<double> x, y;
  Interval x_interval, y_interval;
};

struct PlotSeries {
  std::string label;  ///< in the legend; empty: not in the legend
  PlotTone tone = PlotTone::first;
  PlotMarker marker = PlotMarker::disc;
  PlotLine line = PlotLine::none;
  PlotLine legend_line = PlotLine::none;  ///< in the legend only, where the line is a series of its own
  std::vector<PlotPoint> points;
  double dodge_px = 0;  ///< draws everything this much lower, so that intervals of two series do not hide each other
};

/// A range of x over the full height.
struct PlotBand {
  std::string label;
  PlotTone tone = PlotTone::first;
  Interval x;  ///< an open side reaches the edge
};

/// A horizontal line with its name written above its right end.
struct PlotReference {
  double y = 0;
  std::string label;
};

struct Plot {
  std::string id;                    ///< unique on the page; letters, digits, hyphens
  std::string title;                 ///< for screen readers
  std::string description;           ///< for screen readers: what can be seen
  double width = 860, height = 410;  ///< user units; the picture scales with the page
  PlotAxis x, y;
  std::vector<PlotBand> bands;
  std::vector<PlotReference> references;
  std::vector<PlotSeries> series;  ///< later ones are drawn over earlier ones and stand earlier in the legend
};

/// The plot with its axes, ticks and legend. `invalid_input` for an axis that cannot be drawn.
[[nodiscard]] Result<Drawing> drawn(const Plot& plot);

}  // namespace todbench
