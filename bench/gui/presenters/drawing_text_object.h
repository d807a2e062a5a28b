// Drawings inside a text document.
#pragma once

#include <QObject>
#include <QTextObjectInterface>
#include <vector>

#include "bench/report/drawing.h"

namespace todbench {

/// Paints drawing number property(index_property) of those added, at a width of its own.
class DrawingTextObject final : public QObject, public QTextObjectInterface {
  Q_OBJECT
  Q_INTERFACES(QTextObjectInterface)

 public:
  static constexpr int object_type = QTextFormat::UserObject + 1;
  static constexpr int index_property = 1;
  explicit DrawingTextObject(double page_width_px);
  /// The format of the character that stands for `drawing`.
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
