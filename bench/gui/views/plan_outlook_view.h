// What a plan will cost, how sure its result will be, and which effects are simulated.
#pragma once

#include <QWidget>
#include <vector>

class QComboBox;
class QLabel;
class QSlider;
class QTableWidget;

namespace todbench {

class PlanPresenter;
class PlotView;

class PlanOutlookView final : public QWidget {
  Q_OBJECT

 public:
  explicit PlanOutlookView(PlanPresenter& presenter, QWidget* parent = nullptr);

 signals:
  /// Why a change here was not taken; empty: it was.
  void problem(const QString& sentence);

 private:
  [[nodiscard]] QWidget* effects_table();
  void show_outlook();
  void show_effects();

  PlanPresenter& presenter_;
  QLabel *tolerance_text_, *cost_, *misfit_;
  QSlider* tolerance_;
  QTableWidget *contrasts_, *effects_;
  PlotView* prices_;
  std::vector<QComboBox*> choices_;  ///< in the order of the effects
};

}  // namespace todbench
