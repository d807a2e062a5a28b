// Plan: the form, the TOML under it, and what it will cost.
#pragma once

#include <QWidget>
#include <functional>
#include <utility>
#include <vector>

#include "bench/session/plan.h"

class QComboBox;
class QFormLayout;
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
  /// A line of the form: how it reads the plan, and how it changes one; the text that it returns is what is wrong.
  struct Field {
    QLineEdit* edit;
    std::function<QString(const Plan&)> shown;
    std::function<QString(Plan&, const QString&)> entered;
  };

  [[nodiscard]] QWidget* form_page();
  [[nodiscard]] QWidget* toml_page();
  [[nodiscard]] QWidget* outlook_panel();
  [[nodiscard]] QWidget* effects_table();
  void add_field(QFormLayout& form, const QString& label, const QString& object_name, Field field);
  void add_fields(QFormLayout& form);
  void add_number(QFormLayout& form, const QString& label, const QString& object_name,
                  std::function<double&(Plan&)> place);
  void add_text(QFormLayout& form, const QString& label, const QString& object_name,
                std::function<std::string&(Plan&)> place);
  void enter(const Field& field);
  void show_plan();
  void show_outlook();
  void show_effects();
  void show_reason();
  void complain(const QString& sentence);

  PlanPresenter& presenter_;
  std::vector<Field> fields_;
  QTabWidget* tabs_;
  QPlainTextEdit* toml_;
  QLabel *problem_, *tolerance_text_, *cost_, *misfit_, *reason_;
  QSlider* tolerance_;
  QTableWidget *contrasts_, *effects_;
  PlotView* prices_;
  std::vector<QComboBox*> choices_;  ///< in the order of the effects
};

}  // namespace todbench
