// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/views/field_editor.h"

#include <QApplication>
#include <QCheckBox>
#include <QComboBox>
#include <QFileDialog>
#include <QHeaderView>
#include <QKeyEvent>
#include <QLabel>
#include <QLineEdit>
#include <QMenu>
#include <QSignalBlocker>
#include <QSpinBox>
#include <QStyle>
#include <QVBoxLayout>
#include <algorithm>
#include <vector>

#include "bench/gui/views/layout_pieces.h"

namespace todbench {
namespace {

constexpr int most_rows_shown = 6;

/// A line edit that passes Ctrl+Z to the plan if it has no change of its own to undo.
class PlanLineEdit final : public QLineEdit {
 public:
  bool event(QEvent* event) override {
    if (event->type() == QEvent::ShortcutOverride) {
      const auto* key = static_cast<QKeyEvent*>(event);
      const bool undo = key->matches(QKeySequence::Undo) && !isUndoAvailable();
      const bool redo = key->matches(QKeySequence::Redo) && !isRedoAvailable();
      if (undo || redo) {
        event->ignore();
        return false;
      }
    }
    return QLineEdit::event(event);
  }
};

/// A combo box that ignores the wheel, so that scrolling the form does not change its value.
class StillComboBox final : public QComboBox {
 protected:
  void wheelEvent(QWheelEvent* event) override { event->ignore(); }
};
class StillSpinBox final : public QSpinBox {
 protected:
  void wheelEvent(QWheelEvent* event) override { event->ignore(); }
};

QString words_of(const QString& word) {
  return QString(word).replace('_', ' ');
}

QString table_text(const QTableWidget& table) {
  std::vector<QStringList> rows;
  for (int row = 0; row < table.rowCount(); ++row) {
    QStringList values;
    for (int column = 0; column < table.columnCount(); ++column) {
      const QTableWidgetItem* item = table.item(row, column);
      values << (item == nullptr ? QString() : item->text().trimmed());
    }
    while (!values.isEmpty() && values.back().isEmpty()) values.pop_back();
    if (!values.isEmpty()) rows.push_back(std::move(values));
  }
  if (table.columnCount() > 1) return text_of_rows(rows);
  QStringList lines;
  for (const QStringList& row : rows) lines << row.front();
  return lines.join(", ");
}

bool edits_a_cell(const QTableWidget& table) {
  const QWidget* focus = QApplication::focusWidget();
  return focus != nullptr && table.viewport()->isAncestorOf(focus);
}

/// Emits the table's signals.
void add_row(QTableWidget& table, const QString& text) {
  const int row = table.rowCount();
  table.insertRow(row);
  fit_height(table, most_rows_shown);
  table.setItem(row, 0, new QTableWidgetItem(text));  // NOLINT: of the table
}

/// An empty row is not a value yet; typing into it makes it one.
void edit_new_row(QTableWidget& table) {
  const QSignalBlocker quiet(&table);
  const int row = table.rowCount();
  table.insertRow(row);
  for (int column = 0; column < table.columnCount(); ++column)
    table.setItem(row, column, new QTableWidgetItem);  // NOLINT: of the table
  fit_height(table, most_rows_shown);
  table.setCurrentCell(row, 0);
  table.editItem(table.item(row, 0));
}

/// Shows the rows of a text; a colon separates values only if there are several columns.
void show_rows(QTableWidget& table, const QString& text) {
  const QSignalBlocker quiet(&table);
  std::vector<QStringList> rows;
  if (table.columnCount() > 1) {
    rows = rows_of_text(text);
  } else {
    for (const QString& line : text.split(',', Qt::SkipEmptyParts)) rows.push_back({line});
  }
  table.setRowCount(static_cast<int>(rows.size()));
  for (int row = 0; row < table.rowCount(); ++row) {
    const QStringList& values = rows[static_cast<std::size_t>(row)];
    for (int column = 0; column < table.columnCount(); ++column)
      table.setItem(row, column, new QTableWidgetItem(values.value(column).trimmed()));  // NOLINT: of the table
  }
  fit_height(table, most_rows_shown);
}

}  // namespace

FieldEditor::FieldEditor(const PlanField& field, QWidget* parent) : QWidget(parent) {
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(2);
  switch (field.kind) {
    case FieldKind::text:
    case FieldKind::number:
      make_line(field);
      break;
    case FieldKind::file:
      make_file(field);
      break;
    case FieldKind::whole:
      make_whole(field);
      break;
    case FieldKind::yes_no:
      make_check(field);
      break;
    case FieldKind::choice:
    case FieldKind::name:
      make_combo(field);
      break;
    case FieldKind::boxes:
      make_boxes(field);
      break;
    case FieldKind::rows:
      make_rows(field);
      break;
  }
  problem_ = new QLabel;
  problem_->setObjectName(field.object_name + "Problem");
  problem_->setProperty("role", "problem");
  problem_->setWordWrap(true);
  problem_->hide();
  layout->addWidget(problem_);
}

void FieldEditor::show_text(const QString& text) {
  if (!typing_() && text_() != text) set_text_(text);
}

void FieldEditor::show_problem(const QString& sentence) {
  problem_->setText(sentence.isEmpty() ? QString() : "✗ " + sentence);
  problem_->setVisible(!sentence.isEmpty());
}

void FieldEditor::show_idle(const QString& reason) {
  // Greyed, not disabled: a value may be entered before the line that gives it an effect.
  part_->setProperty("idle", !reason.isEmpty());
  part_->setToolTip(reason.isEmpty() ? tool_tip_ : reason + "\n" + tool_tip_);
  part_->style()->polish(part_);
}

void FieldEditor::set_part(QWidget* part, const PlanField& field) {
  part_ = part;
  tool_tip_ = field.tool_tip;
  part->setObjectName(field.object_name);
  part->setToolTip(field.tool_tip);
  part->setAccessibleName(field.label);
  part->setAccessibleDescription(field.tool_tip);
  setFocusProxy(part);
}

void FieldEditor::make_line(const PlanField& field) {
  auto* edit = new PlanLineEdit;  // NOLINT: of the layout, as every part below
  set_part(edit, field);
  edit->setPlaceholderText(field.when_empty);
  if (field.kind == FieldKind::number) edit->setMaximumWidth(fontMetrics().horizontalAdvance("0000000.000000"));
  layout()->addWidget(edit);
  text_ = [edit] { return edit->text(); };
  set_text_ = [edit](const QString& text) {
    edit->setText(text);
    edit->setCursorPosition(0);  // a long number is shown from its beginning
  };
  typing_ = [edit] { return edit->hasFocus() && edit->isModified(); };
  connect(edit, &QLineEdit::editingFinished, this, [this, edit] {
    if (!edit->isModified()) return;
    edit->setModified(false);
    emit edited();
  });
}

void FieldEditor::make_file(const PlanField& field) {
  make_line(field);
  QPushButton* choose = plain_button("From a file…", field.object_name + "File");
  choose->setAccessibleName("File of " + field.label);
  auto* buttons = new QHBoxLayout;  // NOLINT
  buttons->addWidget(choose);
  buttons->addStretch();
  static_cast<QVBoxLayout*>(layout())->addLayout(buttons);
  connect(choose, &QPushButton::clicked, this, [this] {
    const QString file = QFileDialog::getOpenFileName(this, "Choose a file", {}, "Descriptions (*.toml)");
    if (file.isEmpty()) return;
    set_text_(file);
    emit edited();
  });
}

void FieldEditor::make_whole(const PlanField& field) {
  auto* box = new StillSpinBox;  // NOLINT
  set_part(box, field);
  box->setRange(field.low, field.high);
  box->setKeyboardTracking(false);
  box->setFocusPolicy(Qt::StrongFocus);
  box->setMaximumWidth(fontMetrics().horizontalAdvance("0000000.000000"));
  layout()->addWidget(box);
  text_ = [box] { return QString::number(box->value()); };
  set_text_ = [box](const QString& text) {
    const QSignalBlocker quiet(box);
    box->setValue(text.toInt());
  };
  connect(box, &QSpinBox::valueChanged, this, &FieldEditor::edited);
}

void FieldEditor::make_check(const PlanField& field) {
  auto* box = new QCheckBox("yes");  // NOLINT
  set_part(box, field);
  layout()->addWidget(box);
  text_ = [box] { return QString(box->isChecked() ? "yes" : "no"); };
  set_text_ = [box](const QString& text) { box->setChecked(text == "yes"); };
  connect(box, &QCheckBox::clicked, this, &FieldEditor::edited);
}

void FieldEditor::make_combo(const PlanField& field) {
  auto* box = new StillComboBox;  // NOLINT
  set_part(box, field);
  box->setFocusPolicy(Qt::StrongFocus);
  for (const QString& word : field.words) box->addItem(word);
  layout()->addWidget(box);
  set_text_ = [box](const QString& text) {
    const QSignalBlocker quiet(box);
    if (const int index = box->findText(text); index >= 0) box->setCurrentIndex(index);
    if (box->isEditable()) {
      box->setEditText(text);
      box->lineEdit()->setCursorPosition(0);
    }
  };
  text_ = [box] { return box->currentText(); };
  connect(box, &QComboBox::activated, this, &FieldEditor::edited);
  if (field.kind != FieldKind::name) return;
  box->setEditable(true);
  box->setInsertPolicy(QComboBox::NoInsert);
  QLineEdit* edit = box->lineEdit();
  edit->setAccessibleName(field.label);
  typing_ = [edit] { return edit->hasFocus() && edit->isModified(); };
  connect(edit, &QLineEdit::editingFinished, this, [this, edit] {
    if (!edit->isModified()) return;
    edit->setModified(false);
    emit edited();
  });
}

void FieldEditor::make_boxes(const PlanField& field) {
  auto* group = new QWidget;  // NOLINT
  auto* grid = new QVBoxLayout(group);
  grid->setContentsMargins(0, 0, 0, 0);
  std::vector<QCheckBox*> boxes;
  for (const QString& word : field.words) {
    auto* box = new QCheckBox(words_of(word));  // NOLINT
    box->setObjectName(field.object_name + "_" + word);
    box->setToolTip(field.tool_tip);
    box->setAccessibleName(field.label + ": " + words_of(word));
    grid->addWidget(box);
    connect(box, &QCheckBox::clicked, this, &FieldEditor::edited);
    boxes.push_back(box);
  }
  set_part(group, field);
  setFocusProxy(boxes.front());
  layout()->addWidget(group);
  text_ = [boxes, words = field.words] {
    QStringList chosen;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      if (boxes[i]->isChecked()) chosen << words[static_cast<qsizetype>(i)];
    }
    return chosen.join(", ");
  };
  set_text_ = [boxes, words = field.words](const QString& text) {
    QStringList chosen;
    for (const QString& word : text.split(',')) chosen << word.trimmed();
    for (std::size_t i = 0; i < boxes.size(); ++i)
      boxes[i]->setChecked(chosen.contains(words[static_cast<qsizetype>(i)]));
  };
}

void FieldEditor::make_rows(const PlanField& field) {
  QStringList titles, longest;
  for (const FieldColumn& column : field.columns) {
    titles << column.title;
    if (const auto space = column.title.lastIndexOf(' '); space > 0 && field.columns.size() > most_columns_beside)
      titles.back()[space] = '\n';
    longest << (column.longest.isEmpty() ? column.title : column.longest);
  }
  QTableWidget* table = plain_table(titles, field.object_name);
  set_part(table, field);
  table->setEditTriggers(QAbstractItemView::DoubleClicked | QAbstractItemView::EditKeyPressed |
                         QAbstractItemView::AnyKeyPressed | QAbstractItemView::SelectedClicked);
  table->setSelectionBehavior(QAbstractItemView::SelectItems);
  constexpr int most_width = 430;  // half of the smallest window; wider tables scroll
  const int width = column_widths(*table, longest);
  table->setMinimumWidth(std::min(width, most_width));
  if (width > most_width) table->setHorizontalScrollMode(QAbstractItemView::ScrollPerPixel);
  fit_height(*table, most_rows_shown);
  auto* buttons = new QHBoxLayout;  // NOLINT
  QPushButton* add = plain_button("Add", field.object_name + "Add");
  QPushButton* remove = plain_button("Remove", field.object_name + "Remove");
  add->setAccessibleName("Add to " + field.label);
  remove->setAccessibleName("Remove from " + field.label);
  for (QPushButton* button : {add, remove}) buttons->addWidget(button);
  buttons->addStretch();
  layout()->addWidget(table);
  static_cast<QVBoxLayout*>(layout())->addLayout(buttons);
  text_ = [table] { return table_text(*table); };
  set_text_ = [table](const QString& text) { show_rows(*table, text); };
  typing_ = [table] { return edits_a_cell(*table); };
  connect(table, &QTableWidget::cellChanged, this, &FieldEditor::edited);
  connect(remove, &QPushButton::clicked, this, [this, table] {
    const int row = table->currentRow() >= 0 ? table->currentRow() : table->rowCount() - 1;
    if (row < 0) return;
    table->removeRow(row);
    fit_height(*table, most_rows_shown);
    emit edited();
  });
  if (field.columns.front().words.isEmpty()) {
    connect(add, &QPushButton::clicked, this, [table] { edit_new_row(*table); });
    return;
  }
  auto* menu = new QMenu(add);  // NOLINT
  for (const QString& word : field.columns.front().words)
    connect(menu->addAction(word), &QAction::triggered, this, [table, word] { add_row(*table, word); });
  connect(menu->addAction("From a file…"), &QAction::triggered, this, [this, table] {
    const QString file = QFileDialog::getOpenFileName(this, "Add a file", {}, "Descriptions (*.toml)");
    if (!file.isEmpty()) add_row(*table, file);
  });
  add->setMenu(menu);
}

}  // namespace todbench
