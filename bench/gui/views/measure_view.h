// SPDX-License-Identifier: GPL-3.0-or-later
// Measure view: progress, the growing curves, the arriving answers.
#pragma once

#include <QWidget>
#include <vector>

class QLabel;
class QListWidget;
class QProgressBar;
class QPushButton;
class QTableWidget;
class QCheckBox;
class QFrame;

namespace todbench {

class LookPresenter;
class MeasurePresenter;
class PictureView;
class PlotView;
class Workbench;

/// Page of the measurement.
class MeasureView final : public QWidget {
  Q_OBJECT

 public:
  MeasureView(Workbench& bench, MeasurePresenter& presenter, LookPresenter& look, QWidget* parent = nullptr);

 signals:
  /// The user wants to start or abort a run, or to see the report of the run that ended.
  void start_wanted();
  void abort_wanted();
  void report_wanted();

 protected:
  void showEvent(QShowEvent* event) override;

 private:
  [[nodiscard]] QWidget* log_panel();
  [[nodiscard]] QWidget* notes_panel();
  void show_all();
  void show_curves();
  void show_state();
  void show_log();
  void show_notes();
  void show_judged();
  void make_plots();

  Workbench& bench_;
  MeasurePresenter& presenter_;
  QPushButton *start_, *pause_, *abort_, *answer_, *report_;
  QProgressBar* progress_;
  QLabel *phase_, *left_, *step_, *request_, *judged_text_;
  QFrame* operator_;
  QWidget* functions_;
  std::vector<PlotView*> function_plots_;
  std::vector<double> contrasts_;
  PlotView* tod_;
  QCheckBox* log_log_;
  QTableWidget* log_;
  QListWidget* notes_;
  PictureView *judged_, *live_;
  std::vector<double> shown_key_;
};

}  // namespace todbench
