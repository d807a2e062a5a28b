// The lines of the plan's form as values, from the table of the plan's keys: what each asks for, how it reads a plan
// and changes one.
#pragma once

#include <QString>
#include <QStringList>
#include <functional>
#include <vector>

#include "bench/plan/plan.h"

namespace todbench {

/// What a value asks for.
enum class FieldKind {
  text,
  number,
  whole,   ///< from `low` to `high`
  yes_no,  ///< "yes" or "no"
  choice,  ///< one of `words`
  name,    ///< one of `words`, or a file
  file,    ///< the name of a file
  boxes,   ///< any of `words`, with commas
  rows,    ///< rows with commas, their values with colons; empty values where a column is not needed. A value with one
           ///< of these in it stands in double quotes, its own quotes doubled; not in rows of one column
};

/// Tables of more columns than this stand below their label, not beside it.
inline constexpr std::size_t most_columns_beside = 3;

/// The text of rows of several columns, and the rows of such a text.
[[nodiscard]] QString text_of_rows(const std::vector<QStringList>& rows);
[[nodiscard]] std::vector<QStringList> rows_of_text(const QString& text);

/// A column of a field of rows.
struct FieldColumn {
  QString title;      ///< with the unit
  QStringList words;  ///< names that may stand in it, beside others; none: anything
  QString longest{};  ///< that has to be seen whole; empty: the title
};

/// A line of the form. What it accepts is what can be read and is in range; what the rest of the plan says against it
/// is the plan's to judge.
struct PlanField {
  QString label;        ///< with the unit
  QString tool_tip;     ///< what it is, what it takes and its default
  QString object_name;  ///< of the part of the window
  FieldKind kind = FieldKind::text;
  QStringList words{};
  QString when_empty{};  ///< what an empty text means, where it may be empty
  std::vector<FieldColumn> columns{};
  int low = 0, high = 0;
  std::vector<std::string> paths{};  ///< of its keys: Error::key with one of these is about this line
  std::function<QString(const Plan&)> shown{};
  /// Puts a text into the plan. Returns in one sentence why it cannot, and leaves the plan as it is.
  std::function<QString(Plan&, const QString&)> entered{};
};

/// The keys that have a line, in the order of the table (bench/plan/plan_key_table.cpp).
[[nodiscard]] std::vector<PlanField> plan_fields();

}  // namespace todbench
