// Human observer: one patch, four keys.
#pragma once

#include <QWidget>

class QCheckBox;
class QLabel;
class QPushButton;
class QSpinBox;

namespace todbench {

class HumanPresenter;
class MeasurePresenter;
class PictureView;
class Workbench;

class HumanView final : public QWidget {
  Q_OBJECT

 public:
  HumanView(Workbench& bench, HumanPresenter& presenter, MeasurePresenter& measured, QWidget* parent = nullptr);

 protected:
  void keyPressEvent(QKeyEvent* event) override;

 private:
  void begin();
  void show_state();

  Workbench& bench_;
  HumanPresenter& presenter_;
  MeasurePresenter& measured_;
  PictureView* picture_;
  QSpinBox *per_size_, *shown_ms_;
  QCheckBox* limited_;
  QPushButton *begin_, *abort_;
  QLabel *progress_, *result_;
};

}  // namespace todbench
