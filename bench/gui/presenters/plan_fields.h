// The lines of the plan's form as values, from the table of the plan's keys: how each reads a plan and changes one.
#pragma once

#include <QString>
#include <functional>
#include <vector>

#include "bench/plan/plan.h"

namespace todbench {

/// A line of the form. What it accepts is what can be read and is in range; what the rest of the plan says against it
/// is the plan's to judge.
struct PlanField {
  QString label;        ///< with the unit
  QString tool_tip;     ///< what it is, what it takes and its default
  QString object_name;  ///< of the part of the window
  std::function<QString(const Plan&)> shown;
  /// Puts a text into the plan. Returns in one sentence why it cannot, and leaves the plan as it is.
  std::function<QString(Plan&, const QString&)> entered;
};

/// The keys that have a line, in the order of the table (bench/plan/plan_key_table.cpp).
[[nodiscard]] std::vector<PlanField> plan_fields();

}  // namespace todbench
