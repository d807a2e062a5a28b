// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/drawing_painter.h"

#include <QByteArray>
#include <QFontMetricsF>
#include <QImage>
#include <QPainterPath>
#include <QPolygonF>
#include <algorithm>

#include "bench/gui/presenters/text_of.h"

namespace todbench {
namespace {

QColor colour(Ink ink, PlotTone tone) {
  return QColor(text_of(light_palette().of(ink, tone)));
}

QPen pen_of(const PenStyle& style, PlotTone tone) {
  if (style.stroke == Ink::none) return QPen(Qt::NoPen);
  QPen pen(colour(style.stroke, tone), style.width);
  pen.setCapStyle(Qt::FlatCap);
  pen.setJoinStyle(Qt::RoundJoin);
  // Qt measures dashes in pen widths.
  if (style.dash[0] > 0) pen.setDashPattern({style.dash[0] / style.width, style.dash[1] / style.width});
  return pen;
}

QBrush brush_of(const PenStyle& style, PlotTone tone) {
  if (style.fill == Ink::none) return Qt::NoBrush;
  QColor fill = colour(style.fill, tone);
  fill.setAlphaF(static_cast<float>(style.fill_opacity));
  return fill;
}

QPointF point(const Place& place) {
  return {place.x, place.y};
}

QRectF rectangle(const Box& box) {
  return {box.x, box.y, box.width, box.height};
}

/// Works in the units of the drawing.
struct ShapePainter {
  QPainter& painter;

  void operator()(const Segment& line) const { painter.drawLine(point(line.from), point(line.to)); }
  void operator()(const Polyline& line) const {
    for (const auto& run : line.runs) {
      QPolygonF polygon;
      for (const Place& place : run) polygon << point(place);
      painter.drawPolyline(polygon);
    }
  }
  void operator()(const Box& box) const { painter.drawRect(rectangle(box)); }
  void operator()(const Raster& raster) const {
    const QByteArray text(raster.png_base64.data(), static_cast<qsizetype>(raster.png_base64.size()));
    // Without this a PDF contains a JPEG with altered grey values.
    painter.setRenderHint(QPainter::LosslessImageRendering);
    painter.drawImage(rectangle(raster.place), QImage::fromData(QByteArray::fromBase64(text), "PNG"));
  }
  void operator()(const Disc& disc) const { painter.drawEllipse(point(disc.centre), disc.radius, disc.radius); }
};

void paint(QPainter& painter, const Mark& mark) {
  const PenStyle style = style_of(mark.pen);
  painter.setPen(pen_of(style, mark.tone));
  painter.setBrush(brush_of(style, mark.tone));
  std::visit(ShapePainter{painter}, mark.shape);
}

void paint(QPainter& painter, const Label& label) {
  const LabelStyle style = style_of(label.role);
  QFont font("DejaVu Sans");
  font.setPixelSize(static_cast<int>(style.size));
  // A ligature in a PDF would be read back as another character.
  font.setStyleStrategy(QFont::PreferNoShaping);
  const QString text = QString::fromStdString(label.text);
  const double width = QFontMetricsF(font).horizontalAdvance(text);
  const double left = style.anchor == Anchor::middle ? -width / 2 : style.anchor == Anchor::end ? -width : 0;
  painter.save();
  painter.translate(point(label.at));
  if (label.role == LabelRole::y_axis) painter.rotate(-90);
  if (style.halo > 0) {
    QPainterPath letters;
    letters.addText(left, 0, font, text);
    QPen halo(colour(Ink::ground, {}), style.halo);
    halo.setJoinStyle(Qt::RoundJoin);
    painter.strokePath(letters, halo);
  }
  painter.setFont(font);
  painter.setPen(colour(style.ink, {}));
  painter.drawText(QPointF(left, 0), text);
  painter.restore();
}

}  // namespace

void paint_drawing(QPainter& painter, const QRectF& area, const Drawing& drawing) {
  painter.save();
  const double scale = std::min(area.width() / drawing.width, area.height() / drawing.height);
  painter.translate(area.topLeft());
  painter.scale(scale, scale);
  painter.setRenderHint(QPainter::Antialiasing);
  paint(painter, {drawing.frame, Pen::frame});
  painter.save();
  painter.setClipRect(rectangle(drawing.frame), Qt::IntersectClip);
  for (const Mark& mark : drawing.inside) paint(painter, mark);
  painter.restore();
  for (const Mark& mark : drawing.marks) paint(painter, mark);
  for (const Label& label : drawing.labels) paint(painter, label);
  painter.restore();
}

}  // namespace todbench
