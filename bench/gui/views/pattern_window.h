// SPDX-License-Identifier: GPL-3.0-or-later
// Window that shows a test picture full-screen, one pixel of the picture per pixel of the screen.
#pragma once

#include <QImage>
#include <QWidget>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// Picture with its name.
struct NamedPattern {
  std::string name;
  cv::Mat1d levels;  ///< 0 to 1
};

/// Window for test pictures.
class PatternWindow final : public QWidget {
  Q_OBJECT

 public:
  explicit PatternWindow(QScreen& screen);
  /// Returns the size of the screen in physical pixels, for every scale of the screen.
  [[nodiscard]] cv::Size screen_px() const;
  /// Fills the whole screen and hides the pointer.
  void fill_screen();
  /// Shows the first picture. The keys right, space and left change the picture; escape and q end.
  void set_patterns(std::vector<NamedPattern> patterns);
  /// Returns the index of the shown picture.
  [[nodiscard]] std::size_t current() const { return current_; }
  /// Shows a centred picture, surrounded by the level of its first pixel. Errors: `invalid_input` (larger than the
  /// screen).
  [[nodiscard]] Result<void> show_levels(const cv::Mat1d& levels);
  /// Returns the screen content at the picture, levels 0 to 1; the painted picture if the screen cannot be read. The
  /// level is the 8-bit grey value common to all three colours. Errors: `integrity` (the colours differ).
  [[nodiscard]] Result<cv::Mat1f> on_screen();

 signals:
  void ended();

 protected:
  void paintEvent(QPaintEvent* event) override;
  void keyPressEvent(QKeyEvent* event) override;

 private:
  void step(int by);
  QScreen& screen_;
  QImage image_;
  std::vector<NamedPattern> patterns_;
  std::size_t current_ = 0;
};

}  // namespace todbench
