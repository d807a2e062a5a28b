// SPDX-License-Identifier: GPL-3.0-or-later
// Plot of the report in the window: the same values, with zoom and the colours of the theme.
#pragma once

#include <qcustomplot.h>

#include "bench/report/plot.h"

namespace todbench {

/// View of a plot. Drag and wheel, or arrow keys, plus and minus, move and zoom; a double click or 0 shows the whole
/// plot.
class PlotView final : public QCustomPlot {
  Q_OBJECT

 public:
  explicit PlotView(QWidget* parent = nullptr);
  /// Shows a plot; keeps the zoom of the user if the scales of the axes do not change.
  void show_plot(const Plot& plot);
  [[nodiscard]] const Plot& shown() const { return plot_; }
  /// Returns the drawn points of a series; empty for an unknown label.
  [[nodiscard]] QVector<QPointF> points(const QString& label) const;

  [[nodiscard]] QSize minimumSizeHint() const override { return {160, 120}; }
  [[nodiscard]] QSize sizeHint() const override { return {360, 260}; }

 protected:
  void changeEvent(QEvent* event) override;
  void mouseDoubleClickEvent(QMouseEvent* event) override;
  void keyPressEvent(QKeyEvent* event) override;
  void focusInEvent(QFocusEvent* event) override;
  void focusOutEvent(QFocusEvent* event) override;
  void paintEvent(QPaintEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;

 private:
  void zoom(double factor);
  void shift(double right, double up);
  void show_all();
  void draw_plot();
  void arrange_legend();
  void set_axis(QCPAxis& axis, const PlotAxis& description, bool keep_range);
  void add_series(const PlotSeries& series);
  void add_intervals(const PlotSeries& series, const QColor& colour);

  Plot plot_;
  bool zoomed_ = false;
};

}  // namespace todbench
