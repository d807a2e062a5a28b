// SPDX-License-Identifier: GPL-3.0-or-later
// Compare and report view: sessions, their curves, their verdict.
#pragma once

#include <QWidget>
#include <filesystem>
#include <optional>
#include <vector>

#include "bench/gui/presenters/session_presenter.h"
#include "tod/comparison/comparison.h"

class QCheckBox;
class QLabel;
class QLineEdit;
class QPushButton;
class QTableWidget;

namespace todbench {

class PlotView;

/// Page of sessions and reports.
class ReportView final : public QWidget {
  Q_OBJECT

 public:
  explicit ReportView(SessionPresenter& presenter, QWidget* parent = nullptr);

 signals:
  /// The user requests a replay of the open session from its frames.
  void replay();
  /// The user requests a new measurement with the plan of the open session.
  void again();
  /// The user requests to continue the run of the open session, which ended early.
  void go_on();

 protected:
  void showEvent(QShowEvent* event) override;

 private:
  [[nodiscard]] QWidget* browser();
  [[nodiscard]] QWidget* session_panel();
  [[nodiscard]] QWidget* results();
  [[nodiscard]] QWidget* letterhead_line();
  /// Returns the session of the selected row; empty: no selection.
  [[nodiscard]] std::optional<std::filesystem::path> chosen() const;
  void list_sessions();
  void show_session();
  /// Shows the letterhead of the laboratory, above the session that contains it.
  void show_letterhead(const std::optional<Letterhead>& letterhead);
  void show_comparison();
  void show_ratios(const std::optional<Comparison>& comparison);
  void show_plot();
  void show_pdf();
  /// Shows on the button that a report is being written, and disables it. A report with many frames takes seconds.
  void show_writing(bool writing);

  SessionPresenter& presenter_;
  std::vector<SessionEntry> listed_;  ///< one per row
  QLineEdit* filter_;
  QTableWidget *sessions_, *ratios_, *limits_, *bill_;
  QLabel *title_, *verdict_, *frames_, *files_;
  QWidget* letterhead_;
  QLabel *logo_, *laboratory_;
  QPushButton *compare_, *export_, *replay_, *again_, *page_, *go_on_, *order_;
  QCheckBox* log_log_;
  PlotView* plot_;
};

}  // namespace todbench
