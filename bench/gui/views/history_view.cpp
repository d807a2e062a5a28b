// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/views/history_view.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QSplitter>
#include <QTableWidget>
#include <QVBoxLayout>
#include <utility>

#include "bench/gui/views/layout_pieces.h"
#include "bench/gui/views/plot_view.h"

namespace todbench {

HistoryView::HistoryView(HistoryPresenter& presenter, std::filesystem::path sessions, QWidget* parent)
    : QWidget(parent), presenter_(presenter), sessions_(std::move(sessions)) {
  auto* layout = new QHBoxLayout(this);
  auto* splitter = new QSplitter;
  splitter->addWidget(list_panel());
  splitter->addWidget(chart_panel());
  splitter->setStretchFactor(0, 2);
  splitter->setStretchFactor(1, 5);
  layout->addWidget(splitter);
  connect(&presenter_, &HistoryPresenter::changed, this, &HistoryView::list_series);
  connect(list_, &QTableWidget::currentCellChanged, this, &HistoryView::show_chart);
}

QWidget* HistoryView::list_panel() {
  auto* panel = new QWidget;
  auto* layout = new QVBoxLayout(panel);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(title_label("Units"));
  list_ = plain_table({"Unit", "Measure", "Checks"}, "historyTable");
  list_->setMinimumWidth(column_widths(*list_, {"Emulated sc2000, serial", "temporal_noise_k", "Checks"}));
  wrap_words(*list_);
  layout->addWidget(list_, 1);
  auto* add = plain_button("Add the sessions of this folder", "historyAdd");
  add->setToolTip(
      "Adds the sessions of cameras that have a serial number. Sessions already in the history are skipped.");
  layout->addWidget(add);
  connect(add, &QPushButton::clicked, this, [this] { presenter_.add_sessions(sessions_); });
  return panel;
}

QWidget* HistoryView::chart_panel() {
  auto* panel = new QWidget;
  auto* layout = new QVBoxLayout(panel);
  layout->setContentsMargins(0, 0, 0, 0);
  title_ = title_label("History");
  title_->setObjectName("historyTitle");
  title_->setWordWrap(true);
  layout->addWidget(title_);
  remark_ = new QLabel;
  remark_->setObjectName("historyRemark");
  remark_->setWordWrap(true);
  layout->addWidget(remark_);
  values_ = new PlotView;
  values_->setObjectName("historyValues");
  layout->addWidget(values_, 3);
  auto* pair = new QHBoxLayout;
  ewma_ = new PlotView;
  ewma_->setObjectName("historyEwma");
  cusum_ = new PlotView;
  cusum_->setObjectName("historyCusum");
  pair->addWidget(ewma_);
  pair->addWidget(cusum_);
  layout->addLayout(pair, 2);
  return panel;
}

void HistoryView::showEvent(QShowEvent* event) {
  QWidget::showEvent(event);
  presenter_.refresh();
}

void HistoryView::list_series() {
  QList<QStringList> rows;
  for (const HistorySeries& series : presenter_.series())
    rows << QStringList{unit_of(series), title_of(series), QString::number(series.values.size())};
  fill_table(*list_, rows);
  if (list_->currentRow() < 0 && !rows.isEmpty()) list_->selectRow(0);
  show_chart();
}

void HistoryView::show_chart() {
  const int row = list_->currentRow();
  const bool chosen = row >= 0 && row < static_cast<int>(presenter_.series().size());
  for (PlotView* plot : {values_, ewma_, cusum_}) plot->setVisible(false);
  if (!chosen) {
    title_->setText("History");
    remark_->setText(presenter_.trouble());
    return;
  }
  const HistorySeries& series = presenter_.series()[static_cast<std::size_t>(row)];
  const HistoryChart chart = history_chart(series);
  title_->setText(unit_of(series) + ": " + title_of(series));
  remark_->setText(chart.remark);
  values_->show_plot(chart.values);
  values_->setVisible(true);
  for (const auto& [view, plot] : {std::pair(ewma_, &chart.ewma), std::pair(cusum_, &chart.cusum)}) {
    if (!*plot) continue;
    view->show_plot(**plot);
    view->setVisible(true);
  }
}

}  // namespace todbench
