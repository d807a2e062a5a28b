// SPDX-License-Identifier: GPL-3.0-or-later
// Picture with visible pixels: zoom, marks and outlines over it, the pixel under the cursor.
#pragma once

#include <QImage>
#include <QPolygonF>
#include <QWidget>
#include <optional>
#include <vector>

namespace todbench {

/// A line drawn over a picture, in its pixels (pixel centres at integers).
struct PictureOutline {
  QPolygonF points;
  QColor colour;
  Qt::PenStyle pen = Qt::SolidLine;
};

/// View of a picture.
class PictureView final : public QWidget {
  Q_OBJECT

 public:
  explicit PictureView(QWidget* parent = nullptr);
  /// Shows a picture.
  void set_image(const QImage& image);
  [[nodiscard]] const QImage& image() const { return image_; }
  /// Sets the lines over the picture.
  void set_outlines(std::vector<PictureOutline> outlines);
  [[nodiscard]] const std::vector<PictureOutline>& outlines() const { return outlines_; }
  /// Sets the pixels that are marked by a ring.
  void set_rings(std::vector<QPoint> rings);
  /// Sets the colour around a picture; default: the base colour of the theme.
  void set_surround(const QColor& colour);
  /// Sets the text that is shown without a picture.
  void set_placeholder(const QString& text);

  /// Shows this part of the picture (in its pixels) as large as fits, for every size of the widget; empty: the whole
  /// picture.
  void set_region(const QRectF& region);
  /// Sets the screen pixels per picture pixel; 0: as large as fits.
  void set_zoom(double zoom);
  [[nodiscard]] double zoom() const { return zoom_; }
  /// Returns the picture pixel at a position of the widget, also outside the picture.
  [[nodiscard]] QPoint pixel_at(const QPointF& place) const;

  [[nodiscard]] QSize sizeHint() const override { return {480, 360}; }
  [[nodiscard]] QSize minimumSizeHint() const override { return {120, 90}; }

 signals:
  void hovered(int column, int row);
  void zoom_changed(double zoom);

 protected:
  void paintEvent(QPaintEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void wheelEvent(QWheelEvent* event) override;
  void keyPressEvent(QKeyEvent* event) override;

 private:
  [[nodiscard]] double scale() const;
  [[nodiscard]] QPointF origin() const;
  void zoom_by(double factor, const QPointF& about);

  QImage image_;
  std::vector<PictureOutline> outlines_;
  std::vector<QPoint> rings_;
  QString placeholder_;
  std::optional<QColor> surround_;
  QRectF region_;  ///< shown part of the picture, until the user zooms or moves
  double zoom_ = 0;
  QPointF shift_;  ///< shift of the centre, in screen pixels
  QPointF dragged_from_;
};

}  // namespace todbench
