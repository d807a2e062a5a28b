// SPDX-License-Identifier: GPL-3.0-or-later
// Plan view: the form, its TOML, and next to them the predicted cost.
#pragma once

#include <QWidget>
#include <vector>

#include "bench/gui/presenters/plan_form.h"

class QLabel;
class QLayout;
class QPlainTextEdit;
class QPushButton;
class QTabWidget;

namespace todbench {

class FieldEditor;
class PlanPresenter;

class PlanView final : public QWidget {
  Q_OBJECT

 public:
  explicit PlanView(PlanPresenter& presenter, QWidget* parent = nullptr);
  /// Opens a file or a shipped plan by name; shows an error below the form if it cannot be read.
  void open_plan(const QString& reference);

 private:
  [[nodiscard]] QWidget* form_page();
  [[nodiscard]] QWidget* toml_page();
  [[nodiscard]] QLayout* buttons();
  void undo();
  void redo();
  void start_afresh();
  void enter(std::size_t line);
  void plan_updated();
  void show_plan();
  void complain(const QString& sentence);

  PlanPresenter& presenter_;
  PlanForm form_;
  Plan shown_;
  std::vector<FieldEditor*> editors_;  ///< in the order of the form's fields
  QTabWidget* tabs_;
  QPlainTextEdit* toml_;
  QLabel* problem_;
  QPushButton *undo_, *redo_;
};

}  // namespace todbench
