// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/views/layout_pieces.h"

#include <QHeaderView>
#include <algorithm>

namespace todbench {

QLabel* title_label(const QString& text) {
  auto* label = new QLabel(text);  // NOLINT: owned by the layout's parent, as all widgets below
  label->setProperty("role", "title");
  return label;
}

QLabel* hint_label(const QString& text) {
  auto* label = new QLabel(text);  // NOLINT
  label->setProperty("role", "hint");
  label->setWordWrap(true);
  return label;
}

QPushButton* primary_button(const QString& text, const QString& object_name) {
  QPushButton* button = plain_button(text, object_name);
  button->setProperty("role", "primary");
  return button;
}

QPushButton* plain_button(const QString& text, const QString& object_name) {
  auto* button = new QPushButton(text);  // NOLINT
  button->setObjectName(object_name);
  return button;
}

QTableWidget* plain_table(const QStringList& header, const QString& object_name) {
  auto* table = new QTableWidget(0, static_cast<int>(header.size()));  // NOLINT
  table->setObjectName(object_name);
  table->setAccessibleName(header.join(", "));
  table->setHorizontalHeaderLabels(header);
  table->verticalHeader()->hide();
  table->setEditTriggers(QAbstractItemView::NoEditTriggers);
  table->setSelectionBehavior(QAbstractItemView::SelectRows);
  table->setAlternatingRowColors(true);
  table->setTabKeyNavigation(false);
  table->setWordWrap(false);
  table->horizontalHeader()->setDefaultAlignment(Qt::AlignLeft | Qt::AlignVCenter);
  // Exactly the remaining width: a stretched last section would keep at least its default width.
  table->horizontalHeader()->setSectionResizeMode(static_cast<int>(header.size()) - 1, QHeaderView::Stretch);
  table->horizontalHeader()->setHighlightSections(false);
  table->verticalHeader()->setDefaultSectionSize(table->fontMetrics().height() + 8);
  return table;
}

void wrap_words(QTableWidget& table) {
  table.setWordWrap(true);
  table.verticalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
}

int column_widths(QTableWidget& table, const QStringList& longest) {
  constexpr int margins = 11;
  const QFontMetrics metrics = table.fontMetrics();
  int total = 2 * table.frameWidth();
  for (int column = 0; column < table.columnCount() && column < longest.size(); ++column) {
    const QTableWidgetItem* title = table.horizontalHeaderItem(column);
    const int heading = title == nullptr ? 0 : metrics.size(0, title->text()).width();
    const int width = std::max(heading, metrics.horizontalAdvance(longest[column])) + margins;
    table.setColumnWidth(column, width);
    total += width;
  }
  return total;
}

void fit_height(QTableWidget& table, int most_rows) {
  const int rows = std::clamp(table.rowCount(), 1, most_rows);
  table.setFixedHeight(table.horizontalHeader()->sizeHint().height() + 2 * table.frameWidth() +
                       rows * table.verticalHeader()->defaultSectionSize());
}

void fit_rows(QTableWidget& table, int least, int most) {
  const auto fit = [&table, least, most] {
    const int rows = table.verticalHeader()->length();
    table.setFixedHeight(
        std::clamp(table.horizontalHeader()->sizeHint().height() + 2 * table.frameWidth() + rows, least, most));
  };
  fit();
  table.setProperty("whole", true);
  // The signals come before the header knows its new length.
  QObject::connect(table.verticalHeader(), &QHeaderView::sectionResized, &table, fit, Qt::QueuedConnection);
  QObject::connect(table.verticalHeader(), &QHeaderView::sectionCountChanged, &table, fit, Qt::QueuedConnection);
}

void fill_table(QTableWidget& table, const QList<QStringList>& rows) {
  table.setUpdatesEnabled(false);
  table.setRowCount(static_cast<int>(rows.size()));
  for (int row = 0; row < rows.size(); ++row) {
    for (int column = 0; column < table.columnCount(); ++column) {
      const QString text = column < rows[row].size() ? rows[row][column] : QString();
      QTableWidgetItem* item = table.item(row, column);
      if (item == nullptr) {
        item = new QTableWidgetItem;  // NOLINT: owned by the table
        table.setItem(row, column, item);
      }
      if (item->text() != text) {
        item->setText(text);
        item->setToolTip(text);
      }
    }
  }
  table.setUpdatesEnabled(true);
}

}  // namespace todbench
