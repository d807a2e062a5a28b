// SPDX-License-Identifier: GPL-3.0-or-later
// Look view: the device tree and the live picture.
#pragma once

#include <QWidget>

class QCheckBox;
class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QPushButton;
class QTreeWidget;

namespace todbench {

class HistogramView;
class LookPresenter;
class PictureView;
class Workbench;

class LookView final : public QWidget {
  Q_OBJECT

 public:
  LookView(Workbench& bench, LookPresenter& presenter, QWidget* parent = nullptr);

 private:
  [[nodiscard]] QWidget* device_panel();
  [[nodiscard]] QWidget* display_panel();
  void list_devices();
  void show_frame();
  void show_reading(int column, int row);
  void show_activity();

  Workbench& bench_;
  LookPresenter& presenter_;
  QTreeWidget* devices_;
  PictureView* picture_;
  HistogramView* histogram_;
  QComboBox *colours_, *mode_;
  QDoubleSpinBox *level_, *span_;
  QCheckBox* marks_;
  QPushButton *start_, *rescan_;
  QLabel *counters_, *reading_, *camera_;
  QPoint cursor_{-1, -1};
};

}  // namespace todbench
