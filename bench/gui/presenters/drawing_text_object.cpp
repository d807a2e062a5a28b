// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/drawing_text_object.h"

#include <algorithm>

#include "bench/gui/presenters/drawing_painter.h"

namespace todbench {

DrawingTextObject::DrawingTextObject(double page_width_px) : page_width_(page_width_px) {}

QTextCharFormat DrawingTextObject::add(const Drawing& drawing) {
  QTextCharFormat format;
  format.setObjectType(object_type);
  format.setProperty(index_property, static_cast<int>(drawings_.size()));
  drawings_.push_back(drawing);
  return format;
}

const Drawing& DrawingTextObject::drawing_of(const QTextFormat& format) const {
  return drawings_.at(static_cast<std::size_t>(format.property(index_property).toInt()));
}

QSizeF DrawingTextObject::intrinsicSize(QTextDocument* /*document*/, int /*position*/, const QTextFormat& format) {
  const Drawing& drawing = drawing_of(format);
  const double width = std::min(page_width_, drawing.width * 0.7);
  return {width, width * drawing.height / drawing.width};
}

void DrawingTextObject::drawObject(QPainter* painter, const QRectF& area, QTextDocument* /*document*/, int /*position*/,
                                   const QTextFormat& format) {
  paint_drawing(*painter, area, drawing_of(format));
}

}  // namespace todbench
