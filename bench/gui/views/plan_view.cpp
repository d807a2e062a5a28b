// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/views/plan_view.h"

#include <QFileDialog>
#include <QFontDatabase>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QPlainTextEdit>
#include <QScrollArea>
#include <QShortcut>
#include <QSignalBlocker>
#include <QStyle>
#include <QTabWidget>
#include <QToolButton>

#include "bench/gui/presenters/plan_presenter.h"
#include "bench/gui/views/field_editor.h"
#include "bench/gui/views/layout_pieces.h"
#include "bench/gui/views/plan_preview_view.h"

namespace todbench {

PlanView::PlanView(PlanPresenter& presenter, QWidget* parent)
    : QWidget(parent), presenter_(presenter), form_(presenter.plan()) {
  auto* layout = new QHBoxLayout(this);
  auto* left = new QVBoxLayout;
  tabs_ = new QTabWidget;
  tabs_->setObjectName("planTabs");
  tabs_->addTab(form_page(), "Form");
  tabs_->addTab(toml_page(), "TOML");
  left->addWidget(tabs_, 1);
  problem_ = new QLabel;
  problem_->setObjectName("planProblem");
  problem_->setProperty("role", "problem");
  problem_->setWordWrap(true);
  problem_->hide();
  left->addWidget(problem_);
  left->addLayout(buttons());
  layout->addLayout(left, 1);
  auto* outlook = new PlanPreviewView(presenter_);
  layout->addWidget(outlook, 1);
  connect(outlook, &PlanPreviewView::problem, this, &PlanView::complain);
  connect(&presenter_, &PlanPresenter::updated, this, &PlanView::plan_updated);
  show_plan();
}

QLayout* PlanView::buttons() {
  auto* line = new QHBoxLayout;
  auto* open = plain_button("Open…", "openPlan");
  auto* save = plain_button("Save as…", "savePlan");
  auto* demo = plain_button("Demonstration plan", "demoPlan");
  undo_ = plain_button("Undo", "undoPlan");
  redo_ = plain_button("Redo", "redoPlan");
  undo_->setToolTip("Undoes the last change of the plan (Ctrl+Z)");
  redo_->setToolTip("Repeats the change that was undone (Ctrl+Shift+Z)");
  for (QPushButton* button : {open, save, demo, undo_, redo_}) line->addWidget(button);
  line->addStretch();
  connect(open, &QPushButton::clicked, this, [this] {
    const QString file = QFileDialog::getOpenFileName(this, "Open a plan", {}, "Plans (*.toml)");
    if (!file.isEmpty()) open_plan(file);
  });
  connect(save, &QPushButton::clicked, this, [this] {
    const QString file = QFileDialog::getSaveFileName(this, "Save the plan", "plan.toml", "Plans (*.toml)");
    if (!file.isEmpty()) complain(presenter_.save(file));
  });
  connect(demo, &QPushButton::clicked, this, [this] { open_plan("demo"); });
  connect(undo_, &QPushButton::clicked, this, &PlanView::undo);
  connect(redo_, &QPushButton::clicked, this, &PlanView::redo);
  const auto key = [this](QKeySequence::StandardKey keys, void (PlanView::*what)()) {
    auto* shortcut = new QShortcut(keys, this);
    shortcut->setContext(Qt::WidgetWithChildrenShortcut);
    connect(shortcut, &QShortcut::activated, this, what);
  };
  key(QKeySequence::Undo, &PlanView::undo);
  key(QKeySequence::Redo, &PlanView::redo);
  return line;
}

QWidget* PlanView::form_page() {
  auto* content = new QWidget;
  auto* sections = new QVBoxLayout(content);
  QFormLayout* form = nullptr;
  QString section;
  for (std::size_t i = 0; i < form_.fields().size(); ++i) {
    const PlanField& field = form_.fields()[i];
    if (form == nullptr || field.section != section) {
      section = field.section;
      form = add_section(*sections, section);
    }
    folds_of_.push_back(folds_.back());
    auto* editor = new FieldEditor(field);
    auto* label = new QLabel(field.label);
    label->setToolTip(field.tool_tip);
    label->setBuddy(editor);
    if (field.columns.size() > most_columns_beside) {
      form->addRow(label);
      form->addRow(editor);
    } else {
      form->addRow(label, editor);
    }
    connect(editor, &FieldEditor::edited, this, [this, i] { enter(i); });
    editors_.push_back(editor);
  }
  sections->addStretch();
  auto* scroll = new QScrollArea;
  scroll->setObjectName("planForm");
  scroll->setWidgetResizable(true);
  scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  scroll->setFrameShape(QFrame::NoFrame);
  scroll->setFocusPolicy(Qt::NoFocus);
  scroll->setWidget(content);
  // Scrolls vertically only: at least as wide as its lines.
  scroll->setMinimumWidth(content->minimumSizeHint().width() +
                          scroll->style()->pixelMetric(QStyle::PM_ScrollBarExtent) + 2);
  return scroll;
}

QFormLayout* PlanView::add_section(QVBoxLayout& sections, const QString& title) {
  auto* fold = new QToolButton;
  fold->setObjectName("planSection" + QString(title).remove(' '));
  fold->setText(title);
  fold->setAccessibleName("Section " + title);
  fold->setToolTip("Folds and unfolds the lines of this section");
  fold->setProperty("role", "fold");
  fold->setCheckable(true);
  fold->setChecked(true);
  fold->setAutoRaise(true);
  fold->setArrowType(Qt::DownArrow);
  fold->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
  auto* lines = new QWidget;
  auto* form = new QFormLayout(lines);
  form->setContentsMargins(0, 0, 0, 0);
  form->setFieldGrowthPolicy(QFormLayout::AllNonFixedFieldsGrow);
  connect(fold, &QToolButton::toggled, lines, [fold, lines](bool open) {
    lines->setVisible(open);
    fold->setArrowType(open ? Qt::DownArrow : Qt::RightArrow);
  });
  sections.addWidget(fold);
  sections.addWidget(lines);
  folds_.push_back(fold);
  return form;
}

QWidget* PlanView::toml_page() {
  auto* page = new QWidget;
  auto* layout = new QVBoxLayout(page);
  toml_ = new QPlainTextEdit;
  toml_->setObjectName("planToml");
  toml_->setAccessibleName("Plan as TOML");
  toml_->setFont(QFontDatabase::systemFont(QFontDatabase::FixedFont));
  toml_->setTabChangesFocus(true);
  layout->addWidget(toml_, 1);
  toml_state_ = new QLabel;
  toml_state_->setObjectName("tomlState");
  toml_state_->setWordWrap(true);
  layout->addWidget(toml_state_);
  auto* apply = plain_button("Write as the program does", "applyToml");
  apply->setToolTip("Uses the text and writes it again with every key, in the order of the program");
  layout->addWidget(apply, 0, Qt::AlignLeft);
  connect(apply, &QPushButton::clicked, this, [this] {
    use_toml();
    if (toml_wrong_.isEmpty()) start_afresh();
  });
  constexpr int pause_ms = 300;
  toml_delay_.setSingleShot(true);
  toml_delay_.setInterval(pause_ms);
  connect(&toml_delay_, &QTimer::timeout, this, &PlanView::use_toml);
  connect(toml_, &QPlainTextEdit::textChanged, this, [this] {
    toml_edited_ = true;
    toml_delay_.start();
  });
  return page;
}

void PlanView::use_toml() {
  toml_delay_.stop();
  if (!toml_edited_) return;
  toml_wrong_ = presenter_.apply_toml(toml_->toPlainText());
  if (toml_wrong_.isEmpty()) form_.reset(presenter_.plan());
  complain({});
  show_plan();
}

QString PlanView::unused_entry() const {
  if (toml_edited_ && !toml_wrong_.isEmpty()) return toml_wrong_;
  return form_.right() || !form_.changed() ? QString() : problem_->text();
}

void PlanView::show_toml() {
  const bool replace = !toml_edited_ || (toml_wrong_.isEmpty() && !toml_delay_.isActive() && !toml_->hasFocus());
  if (const QString text = presenter_.toml(); replace && text != toml_->toPlainText()) {
    const QSignalBlocker quiet(toml_);
    toml_->setPlainText(text);
    toml_edited_ = false;
  }
  const bool wrong = toml_edited_ && !toml_wrong_.isEmpty();
  toml_state_->setProperty("role", wrong ? "problem" : "hint");
  toml_state_->style()->polish(toml_state_);
  toml_state_->setText(wrong ? "✗ Not in use: " + toml_wrong_ : "✓ In use. Edits are checked as you type.");
  tabs_->setTabText(tabs_->count() - 1, wrong ? "TOML ✗" : "TOML");
}

void PlanView::open_plan(const QString& reference) {
  const QString wrong = presenter_.load(reference);
  if (wrong.isEmpty()) start_afresh();
  complain(wrong);
}

void PlanView::undo() {
  // Entered text that is not valid yet is the last change.
  if (form_.right()) presenter_.undo();
  start_afresh();
}

void PlanView::redo() {
  presenter_.redo();
  start_afresh();
}

void PlanView::start_afresh() {
  form_.reset(presenter_.plan());
  toml_edited_ = false;
  toml_wrong_.clear();
  complain({});
  show_plan();
}

void PlanView::enter(std::size_t line) {
  const QString text = editors_[line]->text();
  if (text == form_.text(line)) return;
  form_.enter(line, text);
  if (form_.right()) {
    if (const auto used = presenter_.use(form_.draft()); !used) form_.refused(used.error());
  }
  complain({});
  show_plan();
}

void PlanView::complain(const QString& sentence) {
  QString text = sentence;
  if (text.isEmpty() && !form_.right()) {
    text = form_.changed() ? "The bench still uses the last valid plan."
                           : "The plan is incomplete. A measurement needs the marked lines.";
    for (const QString& other : form_.other_problems()) text += "\n" + other;
  }
  problem_->setText(text.isEmpty() ? QString() : "✗ " + text);
  problem_->setVisible(!text.isEmpty());
}

void PlanView::plan_updated() {
  if (shown_ != presenter_.plan()) form_.rebase(presenter_.plan());
  show_plan();
}

void PlanView::show_plan() {
  shown_ = presenter_.plan();
  for (std::size_t i = 0; i < editors_.size(); ++i) {
    editors_[i]->show_text(form_.text(i));
    editors_[i]->show_problem(form_.problem(i));
    editors_[i]->show_idle(idle_reason(form_.fields()[i], form_.draft()));
    if (!form_.problem(i).isEmpty()) folds_of_[i]->setChecked(true);
  }
  show_toml();
  undo_->setEnabled(presenter_.can_undo() || !form_.right());
  redo_->setEnabled(presenter_.can_redo());
}

}  // namespace todbench
