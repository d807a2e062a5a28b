// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/drawing_text_object.h"

#include <algorithm>

#include "bench/gui/presenters/drawing_painter.h"

namespace todbench {
namespace {

/// Box of what a drawing shows: a picture has empty margins, in which it stands centred on the screen.
Box content_of(const Drawing& drawing) {
  return drawing.labels.empty() && drawing.marks.empty() ? drawing.frame : Box{0, 0, drawing.width, drawing.height};
}

}  // namespace

DrawingTextObject::DrawingTextObject(double page_width_px) : page_width_(page_width_px) {}

QTextCharFormat DrawingTextObject::add(const Drawing& drawing, double most_height_px) {
  QTextCharFormat format;
  format.setObjectType(object_type);
  format.setProperty(index_property, static_cast<int>(drawings_.size()));
  format.setProperty(height_property, most_height_px);
  drawings_.push_back(drawing);
  return format;
}

const Drawing& DrawingTextObject::drawing_of(const QTextFormat& format) const {
  return drawings_.at(static_cast<std::size_t>(format.property(index_property).toInt()));
}

QSizeF DrawingTextObject::intrinsicSize(QTextDocument* /*document*/, int /*position*/, const QTextFormat& format) {
  const QSizeF size = size_of(drawing_of(format), format.property(height_property).toDouble());
  return size.width() <= page_width_ ? size : size * (page_width_ / size.width());
}

QSizeF DrawingTextObject::size_of(const Drawing& drawing, double most_height_px) {
  constexpr double of_the_screen = 0.7;
  const Box seen = content_of(drawing);
  const double scale = std::min(of_the_screen, most_height_px / seen.height);
  return {seen.width * scale, seen.height * scale};
}

void DrawingTextObject::drawObject(QPainter* painter, const QRectF& area, QTextDocument* /*document*/, int /*position*/,
                                   const QTextFormat& format) {
  const Drawing& drawing = drawing_of(format);
  const Box seen = content_of(drawing);
  const double scale = area.width() / seen.width;
  paint_drawing(*painter,
                {area.x() - seen.x * scale, area.y() - seen.y * scale, drawing.width * scale, drawing.height * scale},
                drawing);
}

}  // namespace todbench
