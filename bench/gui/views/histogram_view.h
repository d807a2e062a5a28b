// SPDX-License-Identifier: GPL-3.0-or-later
// Number of pixels per bin of counts, as bars.
#pragma once

#include <QWidget>
#include <vector>

namespace todbench {

/// Widget that draws the bins as bars.
class HistogramView final : public QWidget {
  Q_OBJECT

 public:
  explicit HistogramView(QWidget* parent = nullptr);
  /// Shows the bins, with labels for the lowest and highest count below.
  void show_bins(std::vector<int> bins, const QString& low, const QString& high);
  [[nodiscard]] QSize sizeHint() const override { return {200, 90}; }
  [[nodiscard]] QSize minimumSizeHint() const override { return {120, 70}; }

 protected:
  void paintEvent(QPaintEvent* event) override;

 private:
  std::vector<int> bins_;
  QString low_, high_;
};

}  // namespace todbench
