// The plan's form while it is filled in: what was entered, and what is wrong with it line by line.
#pragma once

#include <QString>
#include <QStringList>
#include <vector>

#include "bench/gui/presenters/plan_fields.h"
#include "bench/plan/plan_keys.h"

namespace todbench {

/// Lines that need each other (a target of kind scpi needs addresses) are entered one after the other: until all are
/// right the plan on the bench stays what it was.
class PlanForm {
 public:
  explicit PlanForm(const Plan& plan);

  [[nodiscard]] const std::vector<PlanField>& fields() const { return fields_; }
  /// What line `i` shows: what was entered last, or what the plan says.
  [[nodiscard]] QString text(std::size_t i) const;
  /// Why line `i` is not right; empty: it is.
  [[nodiscard]] QString problem(std::size_t i) const { return lines_[i].problem; }
  /// What is wrong with keys that have no line.
  [[nodiscard]] const QStringList& other_problems() const { return others_; }
  /// Nothing is wrong: draft() can be put on the bench.
  [[nodiscard]] bool right() const;
  [[nodiscard]] const Plan& draft() const { return draft_; }

  void enter(std::size_t i, const QString& text);
  /// The bench refuses the draft, for example because a file cannot be read.
  void refused(const Error& error);
  /// Everything as the plan says; what was entered is forgotten.
  void reset(const Plan& plan);
  /// The plan has changed elsewhere: what was entered and is not in it stays entered.
  void rebase(const Plan& plan);

 private:
  struct Line {
    QString unreadable;  ///< what was entered and is no value
    QString problem;
    bool entered = false;
  };
  void judge();

  std::vector<PlanField> fields_;
  std::vector<Line> lines_;
  Plan base_, draft_;
  QStringList others_;
};

}  // namespace todbench
