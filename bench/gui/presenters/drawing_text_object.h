// SPDX-License-Identifier: GPL-3.0-or-later
// Drawings inside a text document.
#pragma once

#include <QObject>
#include <QTextObjectInterface>
#include <vector>

#include "bench/report/drawing.h"

namespace todbench {

/// Paints the added drawing with index property(index_property), at its own width.
class DrawingTextObject final : public QObject, public QTextObjectInterface {
  Q_OBJECT
  Q_INTERFACES(QTextObjectInterface)

 public:
  static constexpr int object_type = QTextFormat::UserObject + 1;
  static constexpr int index_property = 1;
  explicit DrawingTextObject(double page_width_px);
  /// Adds a drawing. Returns the format of the character that represents it.
  [[nodiscard]] QTextCharFormat add(const Drawing& drawing);
  QSizeF intrinsicSize(QTextDocument* document, int position, const QTextFormat& format) override;
  void drawObject(QPainter* painter, const QRectF& area, QTextDocument* document, int position,
                  const QTextFormat& format) override;

 private:
  [[nodiscard]] const Drawing& drawing_of(const QTextFormat& format) const;
  std::vector<Drawing> drawings_;
  double page_width_;
};

}  // namespace todbench
