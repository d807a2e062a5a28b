// SPDX-License-Identifier: GPL-3.0-or-later
// Look view: the device tree and the live picture.
#pragma once

#include <QWidget>
#include <vector>

class QCheckBox;
class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QLineEdit;
class QPushButton;
class QTreeWidget;

namespace todbench {

class HistogramView;
class LookPresenter;
class PictureView;
class Workbench;

/// Page of the live picture.
class LookView final : public QWidget {
  Q_OBJECT

 public:
  LookView(Workbench& bench, LookPresenter& presenter, QWidget* parent = nullptr);

 private:
  [[nodiscard]] QWidget* device_panel();
  [[nodiscard]] QWidget* display_panel();
  [[nodiscard]] QWidget* controls_panel();
  void list_devices();
  void show_frame();
  void show_reading(int column, int row);
  void show_activity();
  void show_controls();

  Workbench& bench_;
  LookPresenter& presenter_;
  QTreeWidget* devices_;
  PictureView* picture_;
  HistogramView* histogram_;
  QComboBox *colours_, *mode_;
  QDoubleSpinBox *level_, *span_;
  QCheckBox* marks_;
  QPushButton *start_, *rescan_, *correct_, *snapshot_, *record_;
  std::vector<QLineEdit*> controls_;  ///< fields in the order of all_camera_controls
  QLabel *counters_, *reading_, *camera_;
  QPoint cursor_{-1, -1};
};

}  // namespace todbench
