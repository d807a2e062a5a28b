// SPDX-License-Identifier: GPL-3.0-or-later
// Form of a plan while it is edited: entered texts, and errors of each line.
#pragma once

#include <QString>
#include <QStringList>
#include <vector>

#include "bench/gui/presenters/plan_fields.h"
#include "bench/plan/plan_keys.h"

namespace todbench {

/// Form with entered texts. Lines that depend on each other (a target of kind scpi requires addresses) are entered one
/// after the other. Until all lines are valid, the plan of the bench does not change.
class PlanForm {
 public:
  explicit PlanForm(const Plan& plan);

  [[nodiscard]] const std::vector<PlanField>& fields() const { return fields_; }
  /// Returns the displayed text of line `i`: the last entered text, or the value of the plan.
  [[nodiscard]] QString text(std::size_t i) const;
  /// Returns the error of line `i`; empty: the line is valid.
  [[nodiscard]] QString problem(std::size_t i) const { return lines_[i].problem; }
  /// Returns the errors of keys without a line.
  [[nodiscard]] const QStringList& other_problems() const { return others_; }
  /// Returns whether there are no errors, so that draft() can become the plan of the bench.
  [[nodiscard]] bool right() const;
  /// Returns the plan with all valid entries.
  [[nodiscard]] const Plan& draft() const { return draft_; }
  /// Returns whether entries differ from the plan that was shown last.
  [[nodiscard]] bool changed() const;

  /// Sets the text of line `i`.
  void enter(std::size_t i, const QString& text);
  /// Adds an error with which the bench rejected the draft, for example because a file cannot be read.
  void refused(const Error& error);
  /// Shows the plan in all lines and discards entered texts.
  void reset(const Plan& plan);
  /// Adopts a plan that was changed elsewhere; entered texts that differ from the plan are kept.
  void rebase(const Plan& plan);

 private:
  struct Line {
    QString unreadable;  ///< entered text that is not a valid value
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
