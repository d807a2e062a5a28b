// SPDX-License-Identifier: GPL-3.0-or-later
// Widgets common to all views.
#pragma once

#include <QLabel>
#include <QLayout>
#include <QPushButton>
#include <QTableWidget>

namespace todbench {

/// Returns a heading.
[[nodiscard]] QLabel* title_label(const QString& text);
/// Returns small grey text that wraps.
[[nodiscard]] QLabel* hint_label(const QString& text = {});
/// Returns the button of the main action of a view.
[[nodiscard]] QPushButton* primary_button(const QString& text, const QString& object_name);
/// Returns a button of a secondary action.
[[nodiscard]] QPushButton* plain_button(const QString& text, const QString& object_name);
/// Returns a read-only table with a header row.
[[nodiscard]] QTableWidget* plain_table(const QStringList& header, const QString& object_name);
/// Wraps texts that are too long for their cell. For tables of few rows.
void wrap_words(QTableWidget& table);
/// Sets column widths so that the headings and the texts `longest` fit, one text per column from the first. The last
/// column fills the remaining width. Returns the table width that fits these columns exactly.
int column_widths(QTableWidget& table, const QStringList& longest);
/// Sets the height of the table so that all rows fit, at least one and at most `most_rows`.
void fit_height(QTableWidget& table, int most_rows);
/// Sets the height of the table so that the rows with wrapped words fit, now and after every change, between `least`
/// and `most` pixels.
void fit_rows(QTableWidget& table, int least, int most);
/// Replaces the rows of a table.
void fill_table(QTableWidget& table, const QList<QStringList>& rows);

}  // namespace todbench
