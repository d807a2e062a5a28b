// Plan: the form, the TOML under it, and what it will cost.
#pragma once

#include <QWidget>
#include <vector>

#include "bench/gui/presenters/plan_fields.h"

class QComboBox;
class QLabel;
class QLineEdit;
class QPlainTextEdit;
class QPushButton;
class QSlider;
class QTableWidget;
class QTabWidget;

namespace todbench {

class PlanPresenter;
class PlotView;

class PlanView final : public QWidget {
  Q_OBJECT

 public:
  explicit PlanView(PlanPresenter& presenter, QWidget* parent = nullptr);

 private:
  struct Line {
    QLineEdit* edit;
    PlanField field;
  };

  [[nodiscard]] QWidget* form_page();
  [[nodiscard]] QWidget* toml_page();
  [[nodiscard]] QWidget* outlook_panel();
  [[nodiscard]] QWidget* effects_table();
  void enter(const Line& line);
  void show_plan();
  void show_outlook();
  void show_effects();
  void show_reason();
  void complain(const QString& sentence);

  PlanPresenter& presenter_;
  std::vector<Line> lines_;
  QTabWidget* tabs_;
  QPlainTextEdit* toml_;
  QLabel *problem_, *tolerance_text_, *cost_, *misfit_, *reason_;
  QSlider* tolerance_;
  QTableWidget *contrasts_, *effects_;
  PlotView* prices_;
  std::vector<QComboBox*> choices_;  ///< in the order of the effects
};

}  // namespace todbench
