// SPDX-License-Identifier: GPL-3.0-or-later
// Align view: the plate over the live picture, and the necessary corrections.
#pragma once

#include <QWidget>

class QLabel;
class QPushButton;
class QTableWidget;

namespace todbench {

class AlignPresenter;
class LookPresenter;
class PictureView;
class Workbench;

/// Page of the alignment.
class AlignView final : public QWidget {
  Q_OBJECT

 public:
  AlignView(Workbench& bench, AlignPresenter& presenter, LookPresenter& live, QWidget* parent = nullptr);

 private:
  void show_alignment();
  void show_activity();

  Workbench& bench_;
  AlignPresenter& presenter_;
  PictureView *picture_, *whole_;
  QTableWidget* figures_;
  QLabel *verdict_, *hints_;
  QPushButton* start_;
};

}  // namespace todbench
