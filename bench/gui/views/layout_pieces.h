// The few widgets that every view is made of.
#pragma once

#include <QLabel>
#include <QLayout>
#include <QPushButton>
#include <QTableWidget>

namespace todbench {

/// A heading.
[[nodiscard]] QLabel* title_label(const QString& text);
/// Small grey text that wraps.
[[nodiscard]] QLabel* hint_label(const QString& text = {});
/// The button that does what the view is for.
[[nodiscard]] QPushButton* primary_button(const QString& text, const QString& object_name);
[[nodiscard]] QPushButton* plain_button(const QString& text, const QString& object_name);
/// A read-only table with a header row.
[[nodiscard]] QTableWidget* plain_table(const QStringList& header, const QString& object_name);
/// Cells too narrow for their text show it in several lines; for tables of few rows.
void wrap_words(QTableWidget& table);
/// Columns as wide as their headings and these texts, one for each column from the first; the last takes what is left.
/// Returns the width of a table that these columns just fit into.
int column_widths(QTableWidget& table, const QStringList& longest);
/// As high as its rows, between one and so many.
void fit_height(QTableWidget& table, int most_rows);
/// As high as its rows are with their words wrapped, now and after every change, between these heights in pixels.
void fit_rows(QTableWidget& table, int least, int most);
/// Replaces the rows of a table.
void fill_table(QTableWidget& table, const QList<QStringList>& rows);

}  // namespace todbench
