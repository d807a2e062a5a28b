// SPDX-License-Identifier: GPL-3.0-or-later
// Line of the form of a plan: the widget for its kind of value, with its error below.
#pragma once

#include <QWidget>
#include <functional>

#include "bench/gui/presenters/plan_fields.h"

class QLabel;

namespace todbench {

/// Editor of the text of a field.
class FieldEditor final : public QWidget {
  Q_OBJECT

 public:
  /// Creates the editor. The inner widget has the object name of the field; the error label below it has the same name
  /// followed by "Problem".
  explicit FieldEditor(const PlanField& field, QWidget* parent = nullptr);

  /// Returns the text of the widget.
  [[nodiscard]] QString text() const { return text_(); }
  /// Sets the text without emitting a signal. While the user is typing, the text does not change.
  void show_text(const QString& text);
  /// Shows an error below the widget; empty: none.
  void show_problem(const QString& sentence);
  /// Greys the field and states the reason why the field has no effect; empty: it has an effect.
  void show_idle(const QString& reason);

 signals:
  /// The user changed the value.
  void edited();

 private:
  void make_line(const PlanField& field);
  void make_file(const PlanField& field);
  void make_whole(const PlanField& field);
  void make_check(const PlanField& field);
  void make_combo(const PlanField& field);
  void make_boxes(const PlanField& field);
  void make_rows(const PlanField& field);
  void set_part(QWidget* part, const PlanField& field);

  QWidget* part_ = nullptr;
  QString tool_tip_;
  std::function<QString()> text_;
  std::function<void(const QString&)> set_text_;
  std::function<bool()> typing_ = [] { return false; };
  QLabel* problem_;
};

}  // namespace todbench
