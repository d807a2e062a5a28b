// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/views/page_check.h"

#include <QAbstractButton>
#include <QApplication>
#include <QComboBox>
#include <QFrame>
#include <QHeaderView>
#include <QLabel>
#include <QScrollBar>
#include <QStyle>
#include <QStyleOptionComboBox>
#include <QTableWidget>
#include <QTreeWidget>
#include <algorithm>

#include "bench/gui/views/picture_view.h"
#include "bench/gui/views/plot_view.h"

namespace todbench {
namespace {

QString name_of(const QWidget& part) {
  return part.objectName().isEmpty() ? QString::fromUtf8(part.metaObject()->className()) : part.objectName();
}

QString cut(const QWidget& part, const QString& text) {
  return name_of(part) + ": cut off: " + QString(text).replace('\n', ' ').left(60);
}

/// Whether a widget is on the page and not scrolled out of view.
bool on_the_page(const QWidget& part) {
  return part.isVisible() && !part.visibleRegion().isEmpty();
}

void check_label(const QLabel& label, QStringList& faults) {
  if (label.text().isEmpty() || !label.pixmap(Qt::ReturnByValue).isNull()) return;
  const QSize room = label.size();
  const bool high_enough = !label.wordWrap() || label.heightForWidth(room.width()) <= room.height();
  const bool wide_enough = label.wordWrap() || label.sizeHint().width() <= room.width();
  if (!high_enough || !wide_enough) faults << cut(label, label.text());
}

void check_combo(const QComboBox& box, QStringList& faults) {
  QStyleOptionComboBox option;
  option.initFrom(&box);
  option.editable = box.isEditable();
  const QRect room = box.style()->subControlRect(QStyle::CC_ComboBox, &option, QStyle::SC_ComboBoxEditField, &box);
  if (!box.isEditable() && box.fontMetrics().horizontalAdvance(box.currentText()) > room.width())
    faults << cut(box, box.currentText());
}

void check_table(const QTableWidget& table, QStringList& faults) {
  const int margin = 2 * (table.style()->pixelMetric(QStyle::PM_FocusFrameHMargin, nullptr, &table) + 1);
  const QFontMetrics metrics = table.fontMetrics();
  for (int column = 0; column < table.columnCount(); ++column) {
    if (const QTableWidgetItem* title = table.horizontalHeaderItem(column)) {
      if (metrics.size(0, title->text()).width() > table.columnWidth(column)) faults << cut(table, title->text());
    }
    for (int row = 0; row < table.rowCount(); ++row) {
      const QTableWidgetItem* item = table.item(row, column);
      if (item == nullptr || table.isRowHidden(row) || table.cellWidget(row, column) != nullptr) continue;
      // Rows scrolled out of view are as wide as visible ones.
      const QRect room(0, 0, table.columnWidth(column) - margin, table.rowHeight(row));
      const int flags = table.wordWrap() ? Qt::TextWordWrap : Qt::TextSingleLine;
      const QRect needed = metrics.boundingRect(room, flags, item->text());
      if (needed.width() > room.width() || needed.height() > room.height()) faults << cut(table, item->text());
    }
  }
  if (table.property("whole").toBool() && table.verticalScrollBar()->maximum() > 0)
    faults << name_of(table) + ": rows are hidden below its edge";
  const int width = table.horizontalHeader()->length();
  if (width > table.viewport()->width()) faults << name_of(table) + ": wider than its space";
}

void check_tree(const QTreeWidget& tree, QStringList& faults) {
  for (QTreeWidgetItemIterator item(const_cast<QTreeWidget*>(&tree)); *item != nullptr; ++item) {
    const QRect place = tree.visualItemRect(*item);
    const int needed = tree.fontMetrics().size(0, (*item)->text(0)).width() + ((*item)->icon(0).isNull() ? 0 : 20);
    if (!place.isEmpty() && needed > place.width()) faults << cut(tree, (*item)->text(0));
  }
}

bool is_empty(const PlotView& plot) {
  const auto& series = plot.shown().series;
  return std::all_of(series.begin(), series.end(), [](const PlotSeries& s) { return s.points.empty(); });
}

void check_part(const QWidget& part, QStringList& faults) {
  if (part.objectName() == "messageBar" && part.property("error").toBool()) {
    const auto* text = part.findChild<QLabel*>();
    faults << "error: " + (text == nullptr ? QString() : text->text());
  }
  if (part.property("role") == "problem") faults << "error: " + static_cast<const QLabel&>(part).text();
  if (const auto* plot = qobject_cast<const PlotView*>(&part); plot != nullptr && is_empty(*plot))
    faults << name_of(part) + ": empty plot";
  if (const auto* picture = qobject_cast<const PictureView*>(&part); picture != nullptr && picture->image().isNull())
    faults << name_of(part) + ": empty picture";
  if (const auto* label = qobject_cast<const QLabel*>(&part)) check_label(*label, faults);
  if (const auto* box = qobject_cast<const QComboBox*>(&part)) check_combo(*box, faults);
  if (const auto* table = qobject_cast<const QTableWidget*>(&part)) check_table(*table, faults);
  if (const auto* tree = qobject_cast<const QTreeWidget*>(&part)) check_tree(*tree, faults);
  const auto* button = qobject_cast<const QAbstractButton*>(&part);
  if (button != nullptr && button->fontMetrics().horizontalAdvance(button->text()) + 8 > button->width() &&
      !button->text().isEmpty())
    faults << cut(part, button->text());
}

}  // namespace

QStringList faults_of(const QWidget& page) {
  QStringList faults;
  for (const QWidget* part : page.findChildren<QWidget*>()) {
    if (on_the_page(*part)) check_part(*part, faults);
  }
  return faults;
}

}  // namespace todbench
