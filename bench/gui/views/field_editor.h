// One line of the plan's form: the part that its value asks for, with what is wrong below it.
#pragma once

#include <QWidget>
#include <functional>

#include "bench/gui/presenters/plan_fields.h"

class QLabel;

namespace todbench {

/// Shows and takes the text of a field, whatever it is edited with.
class FieldEditor final : public QWidget {
  Q_OBJECT

 public:
  /// The inner part has the field's object name, the sentence below it that name with "Problem".
  explicit FieldEditor(const PlanField& field, QWidget* parent = nullptr);

  [[nodiscard]] QString text() const { return text_(); }
  /// Emits nothing. Where somebody is typing the text stays.
  void show_text(const QString& text);
  void show_problem(const QString& sentence);

 signals:
  /// Somebody changed the value.
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

  std::function<QString()> text_;
  std::function<void(const QString&)> set_text_;
  std::function<bool()> typing_ = [] { return false; };
  QLabel* problem_;
};

}  // namespace todbench
