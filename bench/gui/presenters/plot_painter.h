// A plot of the report, painted: for pages of a PDF. The window shows the same values with plot_view.h.
#pragma once

#include <QColor>
#include <QPainter>
#include <QRectF>

#include "bench/report/svg_plot.h"

namespace todbench {

/// Okabe and Ito 2008 on a ground.
struct PlotColours {
  QColor ground, ink, grid;
  QColor first, second, third, muted;
  [[nodiscard]] QColor of(PlotTone tone) const;
};
/// The shades of the report: for white paper and light windows, and for dark ones.
[[nodiscard]] PlotColours light_plot_colours();
[[nodiscard]] PlotColours dark_plot_colours();

/// How a line of a plot is drawn, here and in the window.
[[nodiscard]] Qt::PenStyle pen_style(PlotLine line);

/// Fills `area` with the plot, as lines and text. Thread-safe for painters of its own.
void paint_plot(QPainter& painter, const QRectF& area, const Plot& plot, const PlotColours& colours);

}  // namespace todbench
