// SPDX-License-Identifier: GPL-3.0-or-later
// The plan's form while it is edited: entered texts, and errors line by line.
#pragma once

#include <QString>
#include <QStringList>
#include <vector>

#include "bench/gui/presenters/plan_fields.h"
#include "bench/plan/plan_keys.h"

namespace todbench {

/// Lines that depend on each other (a target of kind scpi needs addresses) are entered one after the other. Until all
/// are valid, the plan of the bench does not change.
class PlanForm {
 public:
  explicit PlanForm(const Plan& plan);

  [[nodiscard]] const std::vector<PlanField>& fields() const { return fields_; }
  /// Displayed text of line `i`: the last entered one, or that of the plan.
  [[nodiscard]] QString text(std::size_t i) const;
  /// Error of line `i`; empty: it is valid.
  [[nodiscard]] QString problem(std::size_t i) const { return lines_[i].problem; }
  /// Errors of keys without a line.
  [[nodiscard]] const QStringList& other_problems() const { return others_; }
  /// Whether there are no errors: draft() can become the plan of the bench.
  [[nodiscard]] bool right() const;
  [[nodiscard]] const Plan& draft() const { return draft_; }
  /// Whether entries are not in the plan that was shown last.
  [[nodiscard]] bool changed() const;

  void enter(std::size_t i, const QString& text);
  /// Reports that the bench rejects the draft, for example because a file cannot be read.
  void refused(const Error& error);
  /// Shows the plan in all lines and discards entered texts.
  void reset(const Plan& plan);
  /// Adopts a plan that was changed elsewhere; entered texts that are not in it stay.
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
