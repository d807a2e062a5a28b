// Plots inside a text document.
#pragma once

#include <QObject>
#include <QTextObjectInterface>
#include <vector>

#include "bench/gui/presenters/plot_painter.h"

namespace todbench {

/// Draws plot number property(index_property) of its list at a width of its own.
class PlotTextObject final : public QObject, public QTextObjectInterface {
  Q_OBJECT
  Q_INTERFACES(QTextObjectInterface)

 public:
  static constexpr int object_type = QTextFormat::UserObject + 1;
  static constexpr int index_property = 1;
  PlotTextObject(std::vector<Plot> plots, double page_width);
  QSizeF intrinsicSize(QTextDocument* document, int position, const QTextFormat& format) override;
  void drawObject(QPainter* painter, const QRectF& area, QTextDocument* document, int position,
                  const QTextFormat& format) override;

 private:
  [[nodiscard]] const Plot& plot_of(const QTextFormat& format) const;
  std::vector<Plot> plots_;
  double page_width_;
};

}  // namespace todbench
