// SPDX-License-Identifier: GPL-3.0-or-later
// Painter of a drawing of the report for pages of a PDF. Interactive plots are in views/plot_view.h.
#pragma once

#include <QPainter>
#include <QRectF>

#include "bench/report/drawing.h"

namespace todbench {

/// Fills `area` with the drawing in light shades, as lines and text. Thread-safe if each thread has its own painter.
void paint_drawing(QPainter& painter, const QRectF& area, const Drawing& drawing);

}  // namespace todbench
