// SPDX-License-Identifier: GPL-3.0-or-later
// Chain view: the picture after every stage, side by side.
#pragma once

#include <QWidget>
#include <vector>

#include "sim_devices/sensor/sensor_plan.h"

class QCheckBox;
class QComboBox;
class QDoubleSpinBox;
class QFormLayout;
class QLabel;
class QSlider;
class QSpinBox;

namespace todbench {

class ChainPresenter;
class PictureView;

/// Page of the chain.
class ChainView final : public QWidget {
  Q_OBJECT

 public:
  explicit ChainView(ChainPresenter& presenter, QWidget* parent = nullptr);

 protected:
  void showEvent(QShowEvent* event) override;

 private:
  [[nodiscard]] QWidget* options_panel();
  void add_scene_rows(QFormLayout& form);
  void show_rows();
  [[nodiscard]] double range_m() const;
  void request();
  void show_pictures();

  ChainPresenter& presenter_;
  QFormLayout* form_;
  QComboBox *what_, *sensor_, *apex_, *air_;
  QSlider* range_;
  QLabel* range_text_;
  QDoubleSpinBox *size_, *contrast_;
  QSpinBox* index_;
  std::vector<std::pair<Effect, QCheckBox*>> effects_;
  std::vector<PictureView*> pictures_;
  std::vector<QLabel*> notes_;
  QLabel* problem_;
};

}  // namespace todbench
