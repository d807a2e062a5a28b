// SPDX-License-Identifier: GPL-3.0-or-later
// Lines of the form of a plan as values, generated from the table of plan keys. Each line has the kind of input, and
// functions that read a value from a plan and set it.
#pragma once

#include <QString>
#include <QStringList>
#include <functional>
#include <vector>

#include "bench/plan/plan.h"

namespace todbench {

/// Kind of input of a value.
enum class FieldKind {
  text,
  number,
  whole,   ///< from `low` to `high`
  yes_no,  ///< "yes" or "no"
  choice,  ///< one of `words`
  name,    ///< one of `words`, or a file
  file,    ///< the name of a file
  boxes,   ///< any of `words`, separated by commas
  /// Rows separated by commas, with values separated by colons; unused columns have empty values. A value that contains
  /// one of these characters is in double quotes, with its own quotes doubled; values in rows of one column are never
  /// quoted.
  rows,
};

/// Tables with more columns are placed below their label instead of next to it.
inline constexpr std::size_t most_columns_beside = 3;

/// Convert rows of several columns to text, and back.
[[nodiscard]] QString text_of_rows(const std::vector<QStringList>& rows);
[[nodiscard]] std::vector<QStringList> rows_of_text(const QString& text);

/// Column of a field of the kind `rows`.
struct FieldColumn {
  QString title;      ///< title with the unit
  QStringList words;  ///< suggested names; empty: none. Other texts are accepted too
  QString longest{};  ///< text that must be fully visible; empty: the title
};

/// A line of the form. The line accepts every readable value in range. The validation of the plan finds conflicts with
/// other values.
struct PlanField {
  QString label;        ///< label with the unit
  QString tool_tip;     ///< meaning, accepted values and default
  QString object_name;  ///< object name of the widget
  FieldKind kind = FieldKind::text;
  QStringList words{};
  QString when_empty{};  ///< meaning of an empty text; empty: the text may not be empty
  std::vector<FieldColumn> columns{};
  int low = 0, high = 0;
  /// Paths of the keys of this line. An error with one of them in Error::key belongs to this line.
  std::vector<std::string> paths{};
  /// Returns the text of the line for a plan.
  std::function<QString(const Plan&)> shown{};
  /// Sets a text in the plan. On an error returns a sentence and does not change the plan.
  std::function<QString(Plan&, const QString&)> entered{};
  QString section{};  ///< heading of the lines with the same section
};

/// Returns the reason why a field has no effect in a plan; empty: it has an effect.
[[nodiscard]] QString idle_reason(const PlanField& field, const Plan& plan);

/// Returns one field for each key that has a line, in the order of the table (bench/plan/plan_key_table.cpp).
[[nodiscard]] std::vector<PlanField> plan_fields();

}  // namespace todbench
