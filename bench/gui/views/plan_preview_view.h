// SPDX-License-Identifier: GPL-3.0-or-later
// Predicted cost and uncertainty of a plan, and its simulated effects.
#pragma once

#include <QWidget>
#include <vector>

class QCheckBox;
class QComboBox;
class QLabel;
class QSlider;
class QTableWidget;

namespace todbench {

class PlanPresenter;
class PlotView;

/// Panel of the prediction.
class PlanPreviewView final : public QWidget {
  Q_OBJECT

 public:
  explicit PlanPreviewView(PlanPresenter& presenter, QWidget* parent = nullptr);

 signals:
  /// Reason why a change was rejected; empty: it was accepted.
  void problem(const QString& sentence);

 private:
  [[nodiscard]] QWidget* effects_table();
  void show_outlook();
  void show_effects();
  void show_bill();
  void fold_effects();

  PlanPresenter& presenter_;
  QLabel *tolerance_text_, *cost_, *misfit_;
  QSlider* tolerance_;
  QTableWidget *contrasts_, *effects_, *bill_;
  QCheckBox* neutral_;  ///< shows the rows of neutral effects
  PlotView* prices_;
  std::vector<QComboBox*> choices_;  ///< choices in the order of the effects
};

}  // namespace todbench
