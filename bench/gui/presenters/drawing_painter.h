// A drawing of the report, painted: for pages of a PDF. Interactive plots are views/plot_view.h.
#pragma once

#include <QPainter>
#include <QRectF>

#include "bench/report/drawing.h"

namespace todbench {

/// Fills `area` with the drawing in light shades, as lines and text. Thread-safe for painters of its own.
void paint_drawing(QPainter& painter, const QRectF& area, const Drawing& drawing);

}  // namespace todbench
