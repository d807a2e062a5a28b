// SPDX-License-Identifier: GPL-3.0-or-later
// Support for drawings inside a text document.
#pragma once

#include <QObject>
#include <QTextObjectInterface>
#include <vector>

#include "bench/report/drawing.h"

namespace todbench {

/// Text object that paints one of the added drawings at its own width. property(index_property) of the format is the
/// index of the drawing.
class DrawingTextObject final : public QObject, public QTextObjectInterface {
  Q_OBJECT
  Q_INTERFACES(QTextObjectInterface)

 public:
  static constexpr int object_type = QTextFormat::UserObject + 1;
  static constexpr int index_property = 1, height_property = 2;
  explicit DrawingTextObject(double page_width_px);
  /// Adds a drawing whose height is limited to `most_height_px`. Returns the format of the character that represents
  /// it.
  [[nodiscard]] QTextCharFormat add(const Drawing& drawing, double most_height_px);
  /// Returns the size of a drawing on a page, before the width of the page limits it.
  [[nodiscard]] static QSizeF size_of(const Drawing& drawing, double most_height_px);
  QSizeF intrinsicSize(QTextDocument* document, int position, const QTextFormat& format) override;
  void drawObject(QPainter* painter, const QRectF& area, QTextDocument* document, int position,
                  const QTextFormat& format) override;

 private:
  [[nodiscard]] const Drawing& drawing_of(const QTextFormat& format) const;
  std::vector<Drawing> drawings_;
  double page_width_;
};

}  // namespace todbench
