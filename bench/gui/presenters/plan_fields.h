// The lines of the plan's form as values: how each reads a plan and changes one.
#pragma once

#include <QString>
#include <functional>
#include <vector>

#include "bench/plan/plan.h"

namespace todbench {

/// A line of the form. What it accepts is only what can be read; whether the plan may say so is the plan reader's to
/// judge.
struct PlanField {
  QString label;        ///< with the unit
  QString object_name;  ///< of the part of the window
  std::function<QString(const Plan&)> shown;
  /// Puts a text into the plan. Returns in one sentence why it cannot, and leaves the plan as it is.
  std::function<QString(Plan&, const QString&)> entered;
};

/// All lines, in the order of the form.
[[nodiscard]] std::vector<PlanField> plan_fields();

}  // namespace todbench
