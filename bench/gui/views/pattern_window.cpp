// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/views/pattern_window.h"

#include <QGuiApplication>
#include <QKeyEvent>
#include <QPainter>
#include <QScreen>
#include <QWindow>
#include <algorithm>
#include <cmath>
#include <utility>

namespace todbench {
namespace {

QImage grey_image(const cv::Mat1d& levels) {
  QImage image(levels.cols, levels.rows, QImage::Format_RGB32);
  for (int row = 0; row < levels.rows; ++row) {
    auto* line = reinterpret_cast<QRgb*>(image.scanLine(row));
    for (int column = 0; column < levels.cols; ++column) {
      const int grey = static_cast<int>(std::lround(255 * std::clamp(levels(row, column), 0.0, 1.0)));
      line[column] = qRgb(grey, grey, grey);
    }
  }
  return image;
}

}  // namespace

PatternWindow::PatternWindow(QScreen& screen) : screen_(screen) {
  setAttribute(Qt::WA_OpaquePaintEvent);
  setWindowTitle(tr("Test picture"));
  setCursor(Qt::BlankCursor);
  setFocusPolicy(Qt::StrongFocus);
}

cv::Size PatternWindow::screen_px() const {
  const double scale = screen_.devicePixelRatio();
  const QSize size = screen_.geometry().size();
  return {static_cast<int>(std::lround(size.width() * scale)), static_cast<int>(std::lround(size.height() * scale))};
}

void PatternWindow::fill_screen() {
  setWindowFlag(Qt::FramelessWindowHint);
  setGeometry(screen_.geometry());
  create();
  if (windowHandle() != nullptr) windowHandle()->setScreen(&screen_);
  setGeometry(screen_.geometry());
  showFullScreen();
}

void PatternWindow::set_patterns(std::vector<NamedPattern> patterns) {
  patterns_ = std::move(patterns);
  current_ = 0;
  step(0);
}

void PatternWindow::step(int by) {
  if (patterns_.empty()) return;
  const auto count = static_cast<int>(patterns_.size());
  current_ = static_cast<std::size_t>((static_cast<int>(current_) + by + count) % count);
  image_ = grey_image(patterns_[current_].levels);
  update();
}

Result<void> PatternWindow::show_levels(const cv::Mat1d& levels) {
  const cv::Size room = screen_px();
  if (levels.empty() || levels.cols > room.width || levels.rows > room.height) {
    return fail(ErrorCode::invalid_input,
                QString("a picture of %1 x %2 pixels does not fit on the screen of %3 x %4 pixels")
                    .arg(levels.cols)
                    .arg(levels.rows)
                    .arg(room.width)
                    .arg(room.height)
                    .toStdString());
  }
  image_ = grey_image(levels);
  repaint();
  return {};
}

void PatternWindow::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  if (image_.isNull()) {
    painter.fillRect(rect(), Qt::black);
    return;
  }
  const double scale = devicePixelRatioF();
  painter.fillRect(rect(), QColor(image_.pixel(0, 0)));
  // Work in physical pixels: undo the painter's scale.
  painter.scale(1 / scale, 1 / scale);
  const int room_x = static_cast<int>(std::lround(width() * scale)),
            room_y = static_cast<int>(std::lround(height() * scale));
  painter.drawImage(QPoint((room_x - image_.width()) / 2, (room_y - image_.height()) / 2), image_);
}

void PatternWindow::keyPressEvent(QKeyEvent* event) {
  switch (event->key()) {
    case Qt::Key_Right:
    case Qt::Key_Space:
    case Qt::Key_PageDown:
      step(1);
      return;
    case Qt::Key_Left:
    case Qt::Key_PageUp:
      step(-1);
      return;
    case Qt::Key_Escape:
    case Qt::Key_Q:
      emit ended();
      return;
    default:
      QWidget::keyPressEvent(event);
  }
}

Result<cv::Mat1f> PatternWindow::on_screen() {
  QImage seen = screen_.grabWindow(winId()).toImage();
  const double scale = devicePixelRatioF();
  const QSize whole(static_cast<int>(std::lround(width() * scale)), static_cast<int>(std::lround(height() * scale)));
  if (seen.size() != whole) seen = grab().toImage();
  seen = seen.convertToFormat(QImage::Format_RGB32);
  const QPoint origin((whole.width() - image_.width()) / 2, (whole.height() - image_.height()) / 2);
  if (seen.size() != whole || image_.isNull()) return fail(ErrorCode::integrity, "the screen cannot be read back");
  cv::Mat1f levels(image_.height(), image_.width());
  for (int row = 0; row < levels.rows; ++row) {
    const auto* line = reinterpret_cast<const QRgb*>(seen.constScanLine(row + origin.y())) + origin.x();
    for (int column = 0; column < levels.cols; ++column) {
      const int grey = qGreen(line[column]);
      if (qRed(line[column]) != grey || qBlue(line[column]) != grey)
        return fail(ErrorCode::integrity,
                    "the picture on the screen is not grey; switch off colour correction and night mode");
      levels(row, column) = static_cast<float>(grey) / 255;
    }
  }
  return levels;
}

}  // namespace todbench
