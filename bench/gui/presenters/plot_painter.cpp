#include "bench/gui/presenters/plot_painter.h"

#include <QFontMetricsF>
#include <QPolygonF>
#include <algorithm>
#include <cmath>

namespace todbench {
namespace {

constexpr double font_px = 13;
constexpr int most_labels = 7;

/// Works in the user units of the plot.
class PlotPainting {
 public:
  PlotPainting(QPainter& painter, const Plot& plot, const PlotColours& colours)
      : painter_(painter),
        plot_(plot),
        colours_(colours),
        frame_(66, 14 + 20 * legend_rows(plot), plot.width - 66 - 18, plot.height - 14 - 20 * legend_rows(plot) - 52) {}

  void operator()() {
    QFont font("DejaVu Sans");
    font.setPixelSize(static_cast<int>(font_px));
    // In a PDF a ligature would be read back as another character.
    font.setStyleStrategy(QFont::PreferNoShaping);
    painter_.setFont(font);
    draw_axes();
    painter_.save();
    painter_.setClipRect(frame_.adjusted(-1, -1, 1, 1), Qt::IntersectClip);
    for (const auto& band : plot_.bands) draw_band(band);
    draw_references();
    for (const auto& series : plot_.series) draw_series(series);
    painter_.restore();
    draw_legend();
  }

 private:
  static int legend_rows(const Plot& plot) {
    const auto named = std::count_if(plot.series.begin(), plot.series.end(),
                                     [](const PlotSeries& series) { return !series.label.empty(); });
    return named == 0 ? 0 : 1 + static_cast<int>((named - 1) / 3);
  }

  static double share(const PlotAxis& axis, double value) {
    if (axis.scale == AxisScale::linear) return (value - axis.low) / (axis.high - axis.low);
    return std::log(std::max(value, 1e-300) / axis.low) / std::log(axis.high / axis.low);
  }
  [[nodiscard]] double x(double value) const { return frame_.left() + share(plot_.x, value) * frame_.width(); }
  [[nodiscard]] double y(double value) const { return frame_.bottom() - share(plot_.y, value) * frame_.height(); }

  void text(const QRectF& where, int flags, const std::string& words) {
    painter_.setPen(colours_.ink);
    painter_.drawText(where, flags | Qt::TextDontClip, QString::fromStdString(words));
  }

  void draw_axes() {
    for (const auto& tick : axis_ticks(plot_.x, most_labels)) {
      if (tick.label.empty()) continue;
      painter_.setPen(QPen(colours_.grid, 0.8));
      painter_.drawLine(QPointF(x(tick.value), frame_.top()), QPointF(x(tick.value), frame_.bottom()));
      text({x(tick.value) - 30, frame_.bottom() + 5, 60, 16}, Qt::AlignHCenter | Qt::AlignTop, tick.label);
    }
    for (const auto& tick : axis_ticks(plot_.y, most_labels)) {
      if (tick.label.empty()) continue;
      painter_.setPen(QPen(colours_.grid, 0.8));
      painter_.drawLine(QPointF(frame_.left(), y(tick.value)), QPointF(frame_.right(), y(tick.value)));
      text({0, y(tick.value) - 8, frame_.left() - 6, 16}, Qt::AlignRight | Qt::AlignVCenter, tick.label);
    }
    painter_.setBrush(Qt::NoBrush);
    painter_.setPen(QPen(colours_.ink, 1));
    painter_.drawRect(frame_);
    text({frame_.left(), frame_.bottom() + 26, frame_.width(), 18}, Qt::AlignHCenter | Qt::AlignTop, plot_.x.label);
    painter_.save();
    painter_.translate(14, frame_.center().y());
    painter_.rotate(-90);
    text({-frame_.height() / 2, -9, frame_.height(), 18}, Qt::AlignCenter, plot_.y.label);
    painter_.restore();
  }

  void draw_band(const PlotBand& band) {
    const double left = band.x.low ? x(*band.x.low) : frame_.left();
    const double right = band.x.high ? x(*band.x.high) : frame_.right();
    QColor fill = colours_.of(band.tone);
    fill.setAlphaF(0.18F);
    painter_.fillRect(QRectF(left, frame_.top(), right - left, frame_.height()), fill);
  }

  void draw_references() {
    for (const auto& reference : plot_.references) {
      painter_.setPen(QPen(colours_.muted, 1, Qt::DashLine));
      painter_.drawLine(QPointF(frame_.left(), y(reference.y)), QPointF(frame_.right(), y(reference.y)));
      text({frame_.left(), y(reference.y) - 17, frame_.width() - 4, 16}, Qt::AlignRight | Qt::AlignBottom,
           reference.label);
    }
  }

  void draw_series(const PlotSeries& series) {
    painter_.save();
    painter_.translate(0, series.dodge_px);
    const QColor colour = colours_.of(series.tone);
    if (series.line != PlotLine::none) {
      painter_.setPen(QPen(colour, 1.8, pen_style(series.line)));
      QPolygonF line;
      for (const auto& point : series.points) {
        if (point.x && point.y) {
          line << QPointF(x(*point.x), y(*point.y));
          continue;
        }
        painter_.drawPolyline(line);
        line.clear();
      }
      painter_.drawPolyline(line);
    }
    painter_.setPen(QPen(colour, 1.4));
    for (const auto& point : series.points) draw_intervals(point);
    for (const auto& point : series.points) {
      if (point.x && point.y) draw_marker(series.marker, colour, {x(*point.x), y(*point.y)});
    }
    painter_.restore();
  }

  void draw_intervals(const PlotPoint& point) {
    if (point.y && (point.x_interval.low || point.x_interval.high)) {
      const double left = point.x_interval.low ? x(*point.x_interval.low) : frame_.left();
      const double right = point.x_interval.high ? x(*point.x_interval.high) : frame_.right();
      painter_.drawLine(QPointF(left, y(*point.y)), QPointF(right, y(*point.y)));
    }
    if (point.x && (point.y_interval.low || point.y_interval.high)) {
      const double low = point.y_interval.low ? y(*point.y_interval.low) : frame_.bottom();
      const double high = point.y_interval.high ? y(*point.y_interval.high) : frame_.top();
      painter_.drawLine(QPointF(x(*point.x), low), QPointF(x(*point.x), high));
    }
  }

  void draw_marker(PlotMarker marker, const QColor& colour, const QPointF& place) {
    constexpr double r = 4;
    painter_.setBrush(colour);
    painter_.setPen(QPen(colours_.ground, 0.8));
    if (marker == PlotMarker::disc) painter_.drawEllipse(place, r, r);
    if (marker == PlotMarker::square) painter_.drawRect(QRectF(place.x() - r, place.y() - r, 2 * r, 2 * r));
    if (marker == PlotMarker::bar) painter_.fillRect(QRectF(place.x() - 1.5, place.y() - 9, 3, 18), colour);
    painter_.setBrush(Qt::NoBrush);
  }

  void draw_legend() {
    const double column_width = (plot_.width - 80) / 3;
    int number = 0;
    for (auto series = plot_.series.rbegin(); series != plot_.series.rend(); ++series) {
      if (series->label.empty()) continue;
      const double left = 66 + column_width * (number % 3);
      const int row = number / 3;
      const double middle = 14 + 20.0 * row;
      const QColor colour = colours_.of(series->tone);
      const PlotLine line = series->line != PlotLine::none ? series->line : series->legend_line;
      painter_.setPen(QPen(colour, 1.8, pen_style(line)));
      if (line != PlotLine::none) painter_.drawLine(QPointF(left, middle), QPointF(left + 26, middle));
      draw_marker(series->marker, colour, {left + 13, middle});
      text({left + 34, middle - 9, column_width - 40, 18}, Qt::AlignLeft | Qt::AlignVCenter, series->label);
      ++number;
    }
  }

  QPainter& painter_;
  const Plot& plot_;
  const PlotColours& colours_;
  QRectF frame_;
};

}  // namespace

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

QColor PlotColours::of(PlotTone tone) const {
  switch (tone) {
    case PlotTone::first:
      return first;
    case PlotTone::second:
      return second;
    case PlotTone::third:
      return third;
    case PlotTone::muted:
      return muted;
  }
  return ink;
}

PlotColours light_plot_colours() {
  return {.ground = QColor(255, 255, 255),
          .ink = QColor(32, 32, 32),
          .grid = QColor(222, 222, 222),
          .first = QColor(0, 114, 178),
          .second = QColor(197, 84, 0),
          .third = QColor(0, 138, 102),
          .muted = QColor(110, 110, 110)};
}

PlotColours dark_plot_colours() {
  return {.ground = QColor(30, 31, 34),
          .ink = QColor(226, 226, 226),
          .grid = QColor(66, 68, 74),
          .first = QColor(86, 180, 233),
          .second = QColor(240, 150, 60),
          .third = QColor(60, 200, 160),
          .muted = QColor(160, 160, 160)};
}

void paint_plot(QPainter& painter, const QRectF& area, const Plot& plot, const PlotColours& colours) {
  if (!validate(plot.x) || !validate(plot.y)) return;
  painter.save();
  const double scale = std::min(area.width() / plot.width, area.height() / plot.height);
  painter.translate(area.topLeft());
  painter.scale(scale, scale);
  painter.setRenderHint(QPainter::Antialiasing);
  PlotPainting(painter, plot, colours)();
  painter.restore();
}

}  // namespace todbench
