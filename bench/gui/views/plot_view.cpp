// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/views/plot_view.h"

#include <QPainter>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "bench/gui/views/theme.h"

namespace todbench {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

Qt::PenStyle pen_style(PlotLine line) {
  switch (line) {
    case PlotLine::none:
      return Qt::NoPen;
    case PlotLine::solid:
      return Qt::SolidLine;
    case PlotLine::dashed:
      return Qt::DashLine;
    case PlotLine::dotted:
      return Qt::DotLine;
  }
  return Qt::SolidLine;
}

/// Ticks at the positions of the report.
class ReportTicker final : public QCPAxisTicker {
 public:
  explicit ReportTicker(PlotAxis axis) : axis_(std::move(axis)) {}
  void generate(const QCPRange& range, const QLocale& /*locale*/, QChar /*format*/, int /*precision*/,
                QVector<double>& ticks, QVector<double>* sub_ticks, QVector<QString>* labels) override {
    PlotAxis shown = axis_;
    shown.low = range.lower;
    shown.high = range.upper;
    ticks.clear();
    if (sub_ticks != nullptr) sub_ticks->clear();
    if (labels != nullptr) labels->clear();
    if (!validate(shown)) return;
    std::erase_if(shown.ticks, [&](double tick) { return tick < range.lower || tick > range.upper; });
    for (const auto& tick : axis_ticks(shown, 6)) {
      if (tick.label.empty()) {
        if (sub_ticks != nullptr) sub_ticks->append(tick.value);
        continue;
      }
      ticks.append(tick.value);
      if (labels != nullptr) labels->append(QString::fromStdString(tick.label));
    }
  }

 private:
  PlotAxis axis_;
};

QCPScatterStyle scatter_of(PlotMarker marker, const QColor& colour) {
  switch (marker) {
    case PlotMarker::none:
      return QCPScatterStyle::ssNone;
    case PlotMarker::disc:
      return {QCPScatterStyle::ssDisc, colour, colour, 7};
    case PlotMarker::square:
      return {QCPScatterStyle::ssSquare, colour, colour, 6};
    case PlotMarker::bar: {
      QPainterPath bar;
      bar.addRect(-1.5, -8, 3, 16);
      return {bar, QPen(colour), colour};
    }
  }
  return QCPScatterStyle::ssNone;
}

}  // namespace

PlotView::PlotView(QWidget* parent) : QCustomPlot(parent) {
  setInteractions(QCP::iRangeDrag | QCP::iRangeZoom);
  setFocusPolicy(Qt::StrongFocus);
  setAccessibleName("Plot");
  connect(this, &QCustomPlot::mouseWheel, this, [this] { zoomed_ = true; });
  connect(this, &QCustomPlot::mouseMove, this, [this](QMouseEvent* event) {
    if ((event->buttons() & Qt::LeftButton) != 0) zoomed_ = true;
  });
  setNoAntialiasingOnDrag(true);
  axisRect()->setupFullAxesBox(false);
  // Above the axes, so that it hides no data.
  plotLayout()->insertRow(0);
  plotLayout()->addElement(0, 0, legend);
  plotLayout()->setRowStretchFactor(0, 0.001);
  plotLayout()->setRowSpacing(0);
  legend->setBorderPen(Qt::NoPen);
  legend->setBrush(Qt::NoBrush);
  legend->setMargins({8, 4, 8, 0});
  // An empty legend would limit the width of its column, including the axes. Margins are added to the maximum, and the
  // sum has to stay below QWIDGETSIZE_MAX: at this value, QCustomPlot takes the legend's preferred width instead.
  legend->setMaximumSize(QWIDGETSIZE_MAX / 2, QWIDGETSIZE_MAX / 2);
}

void PlotView::show_plot(const Plot& plot) {
  if (plot.x.scale != plot_.x.scale || plot.y.scale != plot_.y.scale) zoomed_ = false;
  plot_ = plot;
  draw_plot();
}

void PlotView::changeEvent(QEvent* event) {
  QCustomPlot::changeEvent(event);
  if (event->type() == QEvent::PaletteChange && validate(plot_.x)) draw_plot();
}

void PlotView::mouseDoubleClickEvent(QMouseEvent* event) {
  show_all();
  QCustomPlot::mouseDoubleClickEvent(event);
}

void PlotView::keyPressEvent(QKeyEvent* event) {
  constexpr double step = 0.1;  // of the axis
  switch (event->key()) {
    case Qt::Key_Plus:
    case Qt::Key_Equal:
      return zoom(0.8);
    case Qt::Key_Minus:
      return zoom(1.25);
    case Qt::Key_0:
      return show_all();
    case Qt::Key_Left:
      return shift(-step, 0);
    case Qt::Key_Right:
      return shift(step, 0);
    case Qt::Key_Up:
      return shift(0, step);
    case Qt::Key_Down:
      return shift(0, -step);
    default:
      QCustomPlot::keyPressEvent(event);
  }
}

void PlotView::zoom(double factor) {
  zoomed_ = true;
  for (QCPAxis* axis : {xAxis, yAxis}) axis->scaleRange(factor);
  replot(QCustomPlot::rpQueuedReplot);
}

void PlotView::shift(double right, double up) {
  zoomed_ = true;
  for (const auto& [axis, fraction] : {std::pair{xAxis, right}, std::pair{yAxis, up}}) {
    const QCPRange range = axis->range();
    axis->moveRange(axis->scaleType() == QCPAxis::stLogarithmic ? std::pow(range.upper / range.lower, fraction)
                                                                : range.size() * fraction);
  }
  replot(QCustomPlot::rpQueuedReplot);
}

void PlotView::show_all() {
  zoomed_ = false;
  draw_plot();
}

void PlotView::focusInEvent(QFocusEvent* event) {
  QCustomPlot::focusInEvent(event);
  update();
}

void PlotView::focusOutEvent(QFocusEvent* event) {
  QCustomPlot::focusOutEvent(event);
  update();
}

void PlotView::paintEvent(QPaintEvent* event) {
  QCustomPlot::paintEvent(event);
  if (!hasFocus()) return;
  QPainter painter(this);
  painter.setPen(QPen(palette().color(QPalette::Highlight), 2));
  painter.drawRect(rect().adjusted(1, 1, -1, -1));
}

void PlotView::set_axis(QCPAxis& axis, const PlotAxis& description, bool keep_range) {
  const PlotColours colours = plot_colours_of(theme_of(palette()));
  axis.setScaleType(description.scale == AxisScale::logarithmic ? QCPAxis::stLogarithmic : QCPAxis::stLinear);
  axis.setTicker(QSharedPointer<QCPAxisTicker>(new ReportTicker(description)));
  if (!keep_range) axis.setRange(description.low, description.high);
  axis.setLabel(QString::fromStdString(description.label));
  QFont small = font();
  small.setPixelSize(11);
  axis.setTickLabelFont(small);
  axis.setLabelFont(small);
  axis.setLabelColor(colours.ink);
  axis.setTickLabelColor(colours.ink);
  for (const auto set : {&QCPAxis::setBasePen, &QCPAxis::setTickPen, &QCPAxis::setSubTickPen})
    (axis.*set)(QPen(colours.ink));
  axis.grid()->setPen(QPen(colours.grid, 1));
  axis.grid()->setZeroLinePen(Qt::NoPen);
}

void PlotView::add_intervals(const PlotSeries& series, const QColor& colour) {
  QVector<double> x, y;
  const auto add = [&](double x0, double y0, double x1, double y1) {
    x << x0 << x1 << nothing;
    y << y0 << y1 << nothing;
  };
  for (const auto& p : series.points) {
    if (p.y && (p.x_interval.low || p.x_interval.high))
      add(p.x_interval.low.value_or(plot_.x.low), *p.y, p.x_interval.high.value_or(plot_.x.high), *p.y);
    if (p.x && (p.y_interval.low || p.y_interval.high))
      add(*p.x, p.y_interval.low.value_or(plot_.y.low), *p.x, p.y_interval.high.value_or(plot_.y.high));
  }
  if (x.isEmpty()) return;
  auto* bars = new QCPCurve(xAxis, yAxis);  // NOLINT: owned by the plot
  bars->setData(x, y);
  bars->setPen(QPen(colour, 1.3));
  bars->removeFromLegend();
}

void PlotView::add_series(const PlotSeries& series) {
  const QColor colour = plot_colours_of(theme_of(palette())).of(series.tone);
  add_intervals(series, colour);
  auto* curve = new QCPCurve(xAxis, yAxis);  // NOLINT: owned by the plot
  QVector<double> x, y;
  for (const auto& point : series.points) {
    x << (point.x && point.y ? *point.x : nothing);
    y << (point.x && point.y ? *point.y : nothing);
  }
  curve->setData(x, y);
  curve->setLineStyle(series.line == PlotLine::none ? QCPCurve::lsNone : QCPCurve::lsLine);
  curve->setPen(QPen(colour, 1.8, pen_style(series.line)));
  curve->setScatterStyle(scatter_of(series.marker, colour));
  curve->setName(QString::fromStdString(series.label));
  if (series.label.empty()) curve->removeFromLegend();
}

void PlotView::draw_plot() {
  const PlotColours colours = plot_colours_of(theme_of(palette()));
  clearPlottables();
  clearItems();
  setBackground(colours.ground);
  axisRect()->setBackground(colours.ground);
  set_axis(*xAxis, plot_.x, zoomed_);
  set_axis(*yAxis, plot_.y, zoomed_);
  for (const auto& band : plot_.bands) {
    auto* rectangle = new QCPItemRect(this);  // NOLINT: owned by the plot
    QColor fill = colours.of(band.tone);
    fill.setAlphaF(0.18F);
    rectangle->setPen(Qt::NoPen);
    rectangle->setBrush(fill);
    rectangle->topLeft->setTypeY(QCPItemPosition::ptAxisRectRatio);
    rectangle->bottomRight->setTypeY(QCPItemPosition::ptAxisRectRatio);
    rectangle->topLeft->setCoords(band.x.low.value_or(plot_.x.low), 0);
    rectangle->bottomRight->setCoords(band.x.high.value_or(plot_.x.high), 1);
  }
  for (const auto& reference : plot_.references) {
    auto* line = new QCPItemLine(this);  // NOLINT: owned by the plot
    line->start->setTypeX(QCPItemPosition::ptAxisRectRatio);
    line->end->setTypeX(QCPItemPosition::ptAxisRectRatio);
    line->start->setCoords(0, reference.y);
    line->end->setCoords(1, reference.y);
    line->setPen(QPen(colours.muted, 1, Qt::DashLine));
  }
  for (const auto& series : plot_.series) add_series(series);
  const auto named = std::count_if(plot_.series.begin(), plot_.series.end(),
                                   [](const PlotSeries& series) { return !series.label.empty(); });
  legend->setVisible(named > 1);
  QFont small = font();
  small.setPixelSize(11);
  legend->setFont(small);
  legend->setTextColor(colours.ink);
  arrange_legend();
  replot(QCustomPlot::rpQueuedReplot);
}

/// Uses as many columns as fit.
void PlotView::arrange_legend() {
  constexpr int column_px = 110;
  legend->setWrap(std::clamp(width() / column_px, 2, 4));
  legend->setFillOrder(QCPLegend::foColumnsFirst);
}

void PlotView::resizeEvent(QResizeEvent* event) {
  arrange_legend();
  QCustomPlot::resizeEvent(event);
}

QVector<QPointF> PlotView::points(const QString& label) const {
  for (int i = 0; i < plottableCount(); ++i) {
    const auto* curve = qobject_cast<const QCPCurve*>(const_cast<PlotView*>(this)->plottable(i));
    if (curve == nullptr || label.isEmpty() || curve->name() != label) continue;
    QVector<QPointF> out;
    for (const auto& datum : *curve->data()) out << QPointF(datum.key, datum.value);
    return out;
  }
  return {};
}

}  // namespace todbench
