// See the chain: the picture after every stage, side by side.
#pragma once

#include <QWidget>
#include <vector>

#include "sim_devices/sensor/sensor_plan.h"

class QCheckBox;
class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QSpinBox;

namespace todbench {

class ChainPresenter;
class PictureView;

class ChainView final : public QWidget {
  Q_OBJECT

 public:
  explicit ChainView(ChainPresenter& presenter, QWidget* parent = nullptr);

 protected:
  void showEvent(QShowEvent* event) override;

 private:
  [[nodiscard]] QWidget* options_panel();
  void request();
  void show_pictures();

  ChainPresenter& presenter_;
  QComboBox *sensor_, *apex_;
  QDoubleSpinBox *size_, *contrast_;
  QSpinBox* index_;
  std::vector<std::pair<Effect, QCheckBox*>> effects_;
  std::vector<PictureView*> pictures_;
  std::vector<QLabel*> notes_;
  QLabel* problem_;
};

}  // namespace todbench
