// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/views/picture_view.h"

#include <QKeyEvent>
#include <QMouseEvent>
#include <QPainter>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>
#include <utility>

namespace todbench {
namespace {

constexpr double largest_zoom = 48, least_zoom = 0.25;

}  // namespace

PictureView::PictureView(QWidget* parent) : QWidget(parent) {
  setMouseTracking(true);
  setAccessibleName("Picture");
  setFocusPolicy(Qt::StrongFocus);
  setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Expanding);
  setToolTip("Wheel or + and −: zoom; drag or arrow keys: move; 0: fit");
}

void PictureView::set_image(const QImage& image) {
  image_ = image;
  update();
}

void PictureView::set_outlines(std::vector<PictureOutline> outlines) {
  outlines_ = std::move(outlines);
  update();
}

void PictureView::set_rings(std::vector<QPoint> rings) {
  rings_ = std::move(rings);
  update();
}

void PictureView::set_placeholder(const QString& text) {
  placeholder_ = text;
  update();
}

void PictureView::set_surround(const QColor& colour) {
  surround_ = colour;
  update();
}

void PictureView::set_region(const QRectF& region) {
  region_ = region;
  update();
}

void PictureView::set_zoom(double zoom) {
  zoom_ = zoom <= 0 ? 0 : std::clamp(zoom, least_zoom, largest_zoom);
  if (zoom_ == 0) shift_ = {};
  update();
  emit zoom_changed(scale());
}

double PictureView::scale() const {
  if (zoom_ > 0) return zoom_;
  if (image_.isNull()) return 1;
  if (!region_.isEmpty())
    return std::clamp(std::min(width() / region_.width(), height() / region_.height()), least_zoom, largest_zoom);
  return std::min(static_cast<double>(width()) / image_.width(), static_cast<double>(height()) / image_.height());
}

QPointF PictureView::origin() const {
  const QPointF middle(width() / 2.0, height() / 2.0);
  if (zoom_ <= 0 && !region_.isEmpty()) return middle + shift_ - (region_.center() + QPointF(0.5, 0.5)) * scale();
  return middle + shift_ - QPointF(image_.width(), image_.height()) * scale() / 2;
}

QPoint PictureView::pixel_at(const QPointF& place) const {
  const QPointF pixel = (place - origin()) / scale();
  return {static_cast<int>(std::floor(pixel.x())), static_cast<int>(std::floor(pixel.y()))};
}

void PictureView::paintEvent(QPaintEvent* /*event*/) {
  QPainter painter(this);
  painter.fillRect(rect(), surround_.value_or(palette().color(image_.isNull() ? QPalette::Base : QPalette::Window)));
  if (image_.isNull()) {
    painter.setPen(surround_ ? QColor(Qt::white) : palette().color(QPalette::PlaceholderText));
    painter.drawText(rect().adjusted(20, 20, -20, -20), Qt::AlignCenter | Qt::TextWordWrap, placeholder_);
    return;
  }
  painter.translate(origin());
  painter.scale(scale(), scale());
  painter.drawImage(QPointF(0, 0), image_);
  // Pixel centres are at integers, so the corner of the picture is half a pixel before the first.
  painter.translate(0.5, 0.5);
  painter.setRenderHint(QPainter::Antialiasing);
  for (const auto& outline : outlines_) {
    QPen pen(outline.colour, 1.3, outline.pen);
    pen.setCosmetic(true);
    painter.setPen(pen);
    painter.drawPolygon(outline.points);
  }
  QPen ring(QColor(230, 159, 0), 1.5);
  ring.setCosmetic(true);
  painter.setPen(ring);
  for (const QPoint& place : rings_) painter.drawEllipse(QPointF(place), 3, 3);
}

void PictureView::mouseMoveEvent(QMouseEvent* event) {
  if ((event->buttons() & Qt::LeftButton) != 0) {
    shift_ += event->position() - dragged_from_;
    dragged_from_ = event->position();
    update();
  }
  const QPoint pixel = pixel_at(event->position());
  emit hovered(pixel.x(), pixel.y());
}

void PictureView::mousePressEvent(QMouseEvent* event) {
  dragged_from_ = event->position();
}

void PictureView::wheelEvent(QWheelEvent* event) {
  zoom_by(std::pow(2.0, event->angleDelta().y() / 240.0), event->position());
  event->accept();
}

void PictureView::zoom_by(double factor, const QPointF& about) {
  const double before = scale();
  // Zooming starts at the displayed region.
  if (zoom_ <= 0 && !region_.isEmpty()) {
    shift_ += (QPointF(image_.width(), image_.height()) / 2 - region_.center() - QPointF(0.5, 0.5)) * before;
    zoom_ = before;
  }
  const QPointF from_middle = about - QPointF(width() / 2.0, height() / 2.0) - shift_;
  zoom_ = std::clamp(before * factor, least_zoom, largest_zoom);
  shift_ += from_middle * (1 - zoom_ / before);
  update();
  emit zoom_changed(zoom_);
}

void PictureView::keyPressEvent(QKeyEvent* event) {
  constexpr double step = 24;
  const QPointF middle(width() / 2.0, height() / 2.0);
  switch (event->key()) {
    case Qt::Key_Plus:
    case Qt::Key_Equal:
      zoom_by(std::sqrt(2.0), middle);
      return;
    case Qt::Key_Minus:
      zoom_by(std::sqrt(0.5), middle);
      return;
    case Qt::Key_0:
      set_zoom(0);
      return;
    case Qt::Key_Left:
      shift_ += QPointF(step, 0);
      break;
    case Qt::Key_Right:
      shift_ -= QPointF(step, 0);
      break;
    case Qt::Key_Up:
      shift_ += QPointF(0, step);
      break;
    case Qt::Key_Down:
      shift_ -= QPointF(0, step);
      break;
    default:
      QWidget::keyPressEvent(event);
      return;
  }
  update();
  if (image_.isNull()) return;
  // With keys, the reported pixel is in the centre; with the mouse it is under the pointer.
  const QPoint pixel = pixel_at(middle);
  emit hovered(pixel.x(), pixel.y());
}

}  // namespace todbench
