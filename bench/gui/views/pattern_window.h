// A test picture on a whole screen, a pixel of the picture on a pixel of the screen.
#pragma once

#include <QImage>
#include <QWidget>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/core/result.h"

namespace todbench {

/// A picture with its name.
struct NamedPattern {
  std::string name;
  cv::Mat1d levels;  ///< 0 to 1
};

class PatternWindow final : public QWidget {
  Q_OBJECT

 public:
  explicit PatternWindow(QScreen& screen);
  /// In pixels of the screen, whatever its scale.
  [[nodiscard]] cv::Size screen_px() const;
  /// On the whole screen, without a pointer.
  void fill_screen();
  /// Steps with right, space and left; escape and q end. The first is shown.
  void set_patterns(std::vector<NamedPattern> patterns);
  [[nodiscard]] std::size_t current() const { return current_; }
  /// In the middle; what is round it has the level of its first pixel. `invalid_input`: larger than the screen.
  [[nodiscard]] Result<void> show_levels(const cv::Mat1d& levels);
  /// What is on the screen where the picture is, levels 0 to 1; what was painted where a screen cannot be read. The
  /// eight bits of grey that all three colours have; `integrity` where the colours differ.
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
