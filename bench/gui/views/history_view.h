// SPDX-License-Identifier: GPL-3.0-or-later
// History view: the measures of every unit over the years, with their control charts.
#pragma once

#include <QWidget>
#include <filesystem>

#include "bench/gui/presenters/history_presenter.h"

class QLabel;
class QTableWidget;

namespace todbench {

class PlotView;

/// Page of the history.
class HistoryView final : public QWidget {
  Q_OBJECT

 public:
  /// `sessions`: folder whose sessions a button adds.
  HistoryView(HistoryPresenter& presenter, std::filesystem::path sessions, QWidget* parent = nullptr);

 protected:
  void showEvent(QShowEvent* event) override;

 private:
  [[nodiscard]] QWidget* list_panel();
  [[nodiscard]] QWidget* chart_panel();
  void list_series();
  void show_chart();

  HistoryPresenter& presenter_;
  std::filesystem::path sessions_;
  QTableWidget* list_;
  QLabel *title_, *remark_;
  PlotView *values_, *ewma_, *cusum_;
};

}  // namespace todbench
