// SPDX-License-Identifier: GPL-3.0-or-later
// One line of the plan's form: the widget for its kind of value, with its error below.
#pragma once

#include <QWidget>
#include <functional>

#include "bench/gui/presenters/plan_fields.h"

class QLabel;

namespace todbench {

/// Shows and edits the text of a field.
class FieldEditor final : public QWidget {
  Q_OBJECT

 public:
  /// The inner widget has the field's object name, the error label below it that name with "Problem".
  explicit FieldEditor(const PlanField& field, QWidget* parent = nullptr);

  [[nodiscard]] QString text() const { return text_(); }
  /// Sets the text without emitting a signal. While the user is typing, the text stays.
  void show_text(const QString& text);
  void show_problem(const QString& sentence);
  /// Greys the field and states why it has no effect; empty: it has one.
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
