// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/views/measure_view.h"

#include <QCheckBox>
#include <QFrame>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QListWidget>
#include <QProgressBar>
#include <QScrollBar>
#include <QStyle>
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "bench/gui/presenters/human_presenter.h"
#include "bench/gui/presenters/look_presenter.h"
#include "bench/gui/presenters/measure_presenter.h"
#include "bench/gui/presenters/text_of.h"
#include "bench/gui/views/layout_pieces.h"
#include "bench/gui/views/picture_view.h"
#include "bench/gui/views/plot_view.h"

namespace todbench {
namespace {

/// Changes with every curve: thresholds and numbers of trials.
std::vector<double> key_of(const MeasurePresenter& presenter) {
  std::vector<double> key;
  for (const auto* curve : {&presenter.measured(), &presenter.twin()}) {
    key.push_back(-1);
    if (!*curve) continue;
    for (const auto& point : (*curve)->points) {
      key.push_back(point.fit.trials);
      key.push_back(point.fit.threshold.value_or(0));
      key.push_back(point.direct_s75_mrad.value_or(0));
    }
  }
  return key;
}

/// Names a single curve at the axis: a legend appears from two curves on, and a predicted curve must not pass for a
/// measured one.
Plot with_name_of_single_curve(Plot plot) {
  std::vector<std::string> names;
  for (const PlotSeries& series : plot.series) {
    if (!series.label.empty()) names.push_back(series.label);
  }
  if (names.size() == 1) plot.x.label += ", " + names.front();
  return plot;
}

}  // namespace

MeasureView::MeasureView(Workbench& bench, MeasurePresenter& presenter, LookPresenter& look, QWidget* parent)
    : QWidget(parent), bench_(bench), presenter_(presenter) {
  auto* layout = new QVBoxLayout(this);
  auto* line = new QHBoxLayout;
  start_ = primary_button("Start", "startMeasuring");
  pause_ = plain_button("Pause", "pauseMeasuring");
  abort_ = plain_button("Abort", "abortMeasuring");
  progress_ = new QProgressBar;
  progress_->setObjectName("measureProgress");
  progress_->setFormat("%v of %m presentations");
  phase_ = new QLabel;
  phase_->setObjectName("measurePhase");
  phase_->setProperty("role", "verdict");
  phase_->setWordWrap(true);
  left_ = new QLabel;
  left_->setMinimumWidth(fontMetrics().horizontalAdvance("00 min 00 s left"));
  report_ = primary_button("Open the report", "showReport");
  for (QPushButton* button : {start_, pause_, abort_, report_}) line->addWidget(button);
  line->addWidget(progress_, 1);
  line->addWidget(left_);
  layout->addLayout(line);
  layout->addWidget(phase_);
  step_ = new QLabel;
  step_->setObjectName("nextStep");
  step_->setProperty("role", "step");
  step_->setWordWrap(true);
  layout->addWidget(step_);
  layout->addWidget(notes_panel());

  operator_ = new QFrame;
  operator_->setObjectName("messageBar");
  auto* ask = new QHBoxLayout(operator_);
  request_ = new QLabel;
  request_->setObjectName("operatorRequest");
  request_->setProperty("role", "step");
  request_->setWordWrap(true);
  answer_ = primary_button("Done", "operatorDone");
  live_ = new PictureView;
  live_->setObjectName("operatorPicture");
  live_->set_placeholder("Live picture");
  live_->setFixedSize(240, 180);
  ask->addWidget(live_);
  ask->addWidget(request_, 1);
  ask->addWidget(answer_);
  layout->addWidget(operator_);

  auto* middle = new QGridLayout;
  functions_ = new QWidget;
  functions_->setLayout(new QHBoxLayout);
  functions_->layout()->setContentsMargins(0, 0, 0, 0);
  tod_ = new PlotView;
  tod_->setObjectName("todPlot");
  log_log_ = new QCheckBox("Logarithmic acuity");
  log_log_->setObjectName("logLog");
  auto* tod_column = new QVBoxLayout;
  tod_column->addWidget(tod_, 1);
  tod_column->addWidget(log_log_);
  middle->addWidget(functions_, 0, 0, 1, 2);
  middle->addLayout(tod_column, 1, 0);
  middle->addWidget(log_panel(), 1, 1);
  middle->setColumnStretch(0, 1);
  middle->setColumnStretch(1, 1);
  middle->setRowStretch(0, 1);
  middle->setRowStretch(1, 1);
  layout->addLayout(middle, 1);

  connect(start_, &QPushButton::clicked, this, &MeasureView::start_wanted);
  connect(report_, &QPushButton::clicked, this, &MeasureView::report_wanted);
  connect(pause_, &QPushButton::clicked, this, [this] {
    if (presenter_.state() == RunState::paused) {
      presenter_.resume();
    } else {
      presenter_.pause();
    }
  });
  connect(abort_, &QPushButton::clicked, this, &MeasureView::abort_wanted);
  connect(answer_, &QPushButton::clicked, this, [this] { presenter_.operator_done(); });
  connect(&look, &LookPresenter::updated, this, [this, &look] {
    if (presenter_.operator_request()) live_->set_image(look.image());
  });
  // A camera that sends no frames while it waits has sent those that contradict the request.
  connect(&presenter_, &MeasurePresenter::operator_needed, this, [this, &look] {
    if (!look.image().isNull()) live_->set_image(look.image());
  });
  connect(log_log_, &QCheckBox::toggled, this, [this] {
    shown_key_.clear();
    show_all();
  });
  connect(log_, &QTableWidget::itemSelectionChanged, this, &MeasureView::show_judged);
  connect(&presenter_, &MeasurePresenter::updated, this, &MeasureView::show_all);
  connect(&presenter_, &MeasurePresenter::state_changed, this, &MeasureView::show_state);
  connect(&bench_, &Workbench::activity_changed, this, &MeasureView::show_state);
  show_all();
  show_state();
}

void MeasureView::showEvent(QShowEvent* event) {
  QWidget::showEvent(event);
  show_all();
}

QWidget* MeasureView::log_panel() {
  auto* panel = new QWidget;
  auto* layout = new QHBoxLayout(panel);
  layout->setContentsMargins(0, 0, 0, 0);
  log_ = plain_table({"ΔT (K)", "S (mrad)", "Truth", "Answer", "up", "right", "down", "left", "Source"}, "trialLog");
  log_->setToolTip("Scores of the four directions. The observer answers the direction with the highest score.");
  const int columns =
      column_widths(*log_, {"16.900", "", "right", "right ✓", "0.00", "right", "0.00", "0.00", "camera"});
  log_->setMinimumWidth(columns + log_->verticalScrollBar()->sizeHint().width());
  layout->addWidget(log_, 1);
  auto* side = new QVBoxLayout;
  judged_ = new PictureView;
  judged_->setObjectName("judgedPatch");
  judged_->set_placeholder("Patch");
  judged_->setFixedSize(110, 110);
  judged_text_ = hint_label("Patch of the selected answer, or of the last one");
  judged_text_->setFixedWidth(110);
  side->addWidget(judged_);
  side->addWidget(judged_text_);
  side->addStretch();
  layout->addLayout(side);
  return panel;
}

/// The newest notes: what the run has found before and during the measurement.
QWidget* MeasureView::notes_panel() {
  constexpr int lines_shown = 3;
  notes_ = new QListWidget;
  notes_->setObjectName("measureNotes");
  notes_->setAccessibleName("Notes of the run, the newest first");
  notes_->setToolTip("Notes of the run, the newest first. The report contains them, too.");
  notes_->setWordWrap(true);
  notes_->setSelectionMode(QAbstractItemView::NoSelection);
  notes_->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  notes_->setFixedHeight(lines_shown * notes_->fontMetrics().lineSpacing() + 8);
  notes_->hide();
  return notes_;
}

void MeasureView::show_notes() {
  QStringList newest_first = presenter_.notes();
  std::reverse(newest_first.begin(), newest_first.end());
  QStringList shown;
  for (int row = 0; row < notes_->count(); ++row) shown << notes_->item(row)->text();
  notes_->setVisible(!newest_first.isEmpty());
  if (newest_first == shown) return;
  notes_->clear();
  notes_->addItems(newest_first);
}

void MeasureView::make_plots() {
  const std::vector<double> contrasts = presenter_.contrasts();
  if (contrasts == contrasts_ && !function_plots_.empty()) return;
  contrasts_ = contrasts;
  for (PlotView* plot : function_plots_) delete plot;  // NOLINT: widgets go with their layout items
  function_plots_.clear();
  for (std::size_t i = 0; i < contrasts.size(); ++i) {
    auto* plot = new PlotView;
    plot->setObjectName(QString("psychometricPlot%1").arg(i));
    functions_->layout()->addWidget(plot);
    function_plots_.push_back(plot);
  }
}

void MeasureView::show_all() {
  make_plots();
  const QString phase =
      presenter_.phase().isEmpty() ? "Ready: " + QString::fromStdString(bench_.plan().name) : presenter_.phase();
  phase_->setText(presenter_.waiting().isEmpty() ? phase : phase + ": " + presenter_.waiting());
  left_->setText(presenter_.time_left());
  progress_->setFormat(presenter_.planned() == 0 ? QString() : "%v of %m presentations");
  progress_->setRange(0, std::max(1, static_cast<int>(presenter_.planned())));
  progress_->setValue(static_cast<int>(presenter_.done()));
  const auto& request = presenter_.operator_request();
  operator_->setVisible(request.has_value());
  const QString step = presenter_.next_step();
  // Large letters for a step; the reason of a repeated request is longer than the room for them.
  constexpr qsizetype longest_in_large_letters = 120;
  request_->setProperty("role", step.size() > longest_in_large_letters ? "verdict" : "step");
  request_->style()->polish(request_);
  request_->setText(request ? presenter_.request_number() + "\n" + step : QString());
  step_->setText(request ? QString() : step);
  step_->setVisible(!step_->text().isEmpty());
  show_notes();
  if (!isVisible()) return;
  show_curves();
  show_log();
}

void MeasureView::show_curves() {
  const std::vector<double> key = key_of(presenter_);
  if (key == shown_key_) return;
  shown_key_ = key;
  for (std::size_t i = 0; i < function_plots_.size(); ++i) {
    Plot plot = presenter_.psychometric_plot(contrasts_[i]);
    plot.x.label = plot.title + ", size S (mrad)";
    function_plots_[i]->show_plot(plot);
  }
  tod_->show_plot(with_name_of_single_curve(
      presenter_.tod_plot(log_log_->isChecked() ? AxisScale::logarithmic : AxisScale::linear)));
}

void MeasureView::show_state() {
  const RunState state = presenter_.state();
  start_->setEnabled(state == RunState::idle);
  pause_->setEnabled(state == RunState::running || state == RunState::paused);
  pause_->setText(state == RunState::paused ? "Resume" : "Pause");
  abort_->setEnabled(state == RunState::running || state == RunState::paused);
  report_->setVisible(state == RunState::idle && presenter_.outcome().has_value());
}

void MeasureView::show_log() {
  QList<QStringList> rows;
  constexpr std::size_t shown = 30;
  const auto& recent = presenter_.recent();
  for (std::size_t i = 0; i < std::min(shown, recent.size()); ++i) {
    const Trial& t = recent[i].trial;
    QStringList row{QString::number(t.delta_t_k, 'f', 3), QString::number(t.size_mrad, 'f', 2),
                    text_of(to_string(t.truth)), text_of(to_string(t.answer)) + (t.correct() ? " ✓" : " ✗")};
    for (const double score : t.scores) row << QString::number(score, 'f', 2);
    row << (recent[i].curve == SessionCurve::main ? "camera" : "twin");
    rows << row;
  }
  fill_table(*log_, rows);
  show_judged();
}

void MeasureView::show_judged() {
  const auto& recent = presenter_.recent();
  if (recent.empty()) {
    judged_->set_image({});
    return;
  }
  const auto selected = log_->selectionModel()->selectedRows();
  const std::size_t row = selected.isEmpty() ? 0 : static_cast<std::size_t>(selected.front().row());
  const JudgedTrial& judged = recent[std::min(row, recent.size() - 1)];
  judged_->set_image(picture_for_a_person(judged, 1));
  judged_text_->setText(QString("%1, %2, %3: %4 px, %5 mrad at %6 K")
                            .arg(QString::fromStdString(judged.trial.plate),
                                 QString::fromStdString(judged.trial.triangle),
                                 judged.curve == SessionCurve::main ? "camera" : "twin")
                            .arg(judged.trial.size_px, 0, 'f', 1)
                            .arg(judged.trial.size_mrad, 0, 'f', 2)
                            .arg(judged.trial.delta_t_k, 0, 'f', 2));
}

}  // namespace todbench
