// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/views/histogram_view.h"

#include <QPainter>
#include <algorithm>
#include <cmath>
#include <utility>

namespace todbench {

HistogramView::HistogramView(QWidget* parent) : QWidget(parent) {
  setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
}

void HistogramView::show_bins(std::vector<int> bins, const QString& low, const QString& high) {
  bins_ = std::move(bins);
  low_ = low;
  high_ = high;
  update();
}

void HistogramView::paintEvent(QPaintEvent* /*event*/) {
  QPainter painter(this);
  const int text = fontMetrics().height();
  const QRectF area(0, 0, width(), height() - text - 2);
  painter.fillRect(area, palette().color(QPalette::Base));
  if (bins_.empty()) return;
  // Logarithmic heights: the triangles of a plate are a few percent of the pixels.
  const double highest = std::log1p(*std::max_element(bins_.begin(), bins_.end()));
  const double step = area.width() / static_cast<double>(bins_.size());
  for (std::size_t i = 0; i < bins_.size() && highest > 0; ++i) {
    const double bar = area.height() * std::log1p(bins_[i]) / highest;
    painter.fillRect(QRectF(static_cast<double>(i) * step, area.bottom() - bar, std::max(step - 0.5, 0.5), bar),
                     palette().color(QPalette::Highlight));
  }
  painter.setPen(palette().color(QPalette::Text));
  const QRectF below(0, area.bottom() + 2, width(), text);
  painter.drawText(below, Qt::AlignLeft, low_);
  painter.drawText(below, Qt::AlignRight, high_);
}

}  // namespace todbench
