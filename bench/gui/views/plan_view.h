// SPDX-License-Identifier: GPL-3.0-or-later
// Plan view: the form and its TOML, and the predicted cost next to them.
#pragma once

#include <QTimer>
#include <QWidget>
#include <vector>

#include "bench/gui/presenters/plan_form.h"

class QFormLayout;
class QLabel;
class QLayout;
class QPlainTextEdit;
class QPushButton;
class QTabWidget;
class QToolButton;
class QVBoxLayout;

namespace todbench {

class FieldEditor;
class PlanPresenter;

/// Page of the plan.
class PlanView final : public QWidget {
  Q_OBJECT

 public:
  explicit PlanView(PlanPresenter& presenter, QWidget* parent = nullptr);
  /// Opens a file or a shipped plan by name; shows an error below the form if it cannot be read.
  void open_plan(const QString& reference);
  /// Returns the reason why an entry of the form or an edit of the TOML text is not in use; empty: all entries are in
  /// use.
  [[nodiscard]] QString unused_entry() const;

 private:
  [[nodiscard]] QWidget* form_page();
  /// Adds a heading that folds the lines below it; returns the layout of these lines.
  [[nodiscard]] QFormLayout* add_section(QVBoxLayout& sections, const QString& title);
  [[nodiscard]] QWidget* toml_page();
  [[nodiscard]] QLayout* buttons();
  void undo();
  void redo();
  void start_afresh();
  void enter(std::size_t line);
  void plan_updated();
  void show_plan();
  void show_toml();
  /// Uses the edited text, or marks it with the reason why it is not in use.
  void use_toml();
  void complain(const QString& sentence);

  PlanPresenter& presenter_;
  PlanForm form_;
  Plan shown_;
  std::vector<FieldEditor*> editors_;           ///< editors in the order of the form's fields
  std::vector<QToolButton*> folds_, folds_of_;  ///< one for each section; one for each field
  QTabWidget* tabs_;
  QPlainTextEdit* toml_;
  QLabel* toml_state_;
  QTimer toml_delay_;         ///< delay after the last key stroke
  bool toml_edited_ = false;  ///< the user edited the text; the text is not replaced during the edit
  QString toml_wrong_;        ///< reason why the text is not in use
  QLabel* problem_;
  QPushButton *undo_, *redo_;
};

}  // namespace todbench
