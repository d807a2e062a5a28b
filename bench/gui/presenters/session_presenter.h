// SPDX-License-Identifier: GPL-3.0-or-later
// Sessions on disk: list, open, compare, export, repeat.
#pragma once

#include <QObject>
#include <QString>
#include <optional>
#include <vector>

#include "bench/gui/presenters/workbench.h"
#include "bench/report/report.h"
#include "bench/session/human_record.h"
#include "bench/session/session_folder.h"

namespace todbench {

/// A line of the browser.
struct SessionEntry {
  std::filesystem::path folder;
  QString name, when, state;
  /// Unit as the plan states it, otherwise the model of the camera; "simulation" without a camera.
  QString unit;
  QString serial;   ///< serial number of the camera; empty: no camera
  QString verdict;  ///< "pass", "fail", "inconclusive"; empty: no verdict that the manifest confirms
};

/// Returns the sessions whose serial number, unit, name, date, verdict or state contains every word of `filter`,
/// ignoring case.
[[nodiscard]] std::vector<SessionEntry> matching(const std::vector<SessionEntry>& sessions, const QString& filter);

/// Displayed data of a session.
struct OpenedSession {
  std::filesystem::path folder;
  QString name;
  Session session;
  ReportData report;
  std::optional<HumanRecord> human;
  bool recorded = false;               ///< the session contains its frames and can be replayed
  std::optional<AccuracyBill> bill{};  ///< bill as in the report
};

/// Two compared sessions.
struct ComparedSessions {
  QString a, b;
  TodCurve curve_a, curve_b;
  Comparison comparison;
};

/// Presenter that reads and writes in the background, in the order of the requests. Used in the window's thread.
class SessionPresenter final : public QObject {
  Q_OBJECT

 public:
  explicit SessionPresenter(Workbench& bench, QObject* parent = nullptr);

  /// Lists the sessions of the workbench's folder, newest first; listed() follows.
  void refresh();
  [[nodiscard]] const std::vector<SessionEntry>& sessions() const { return sessions_; }
  /// Reads a session; opened() or problem() follows.
  void open(const std::filesystem::path& folder);
  /// Reads a session and writes its reports again, because the session has new answers of a person. exported() follows
  /// opened().
  void open_and_export(const std::filesystem::path& folder);
  /// Returns the open session; empty if there is none.
  [[nodiscard]] const std::optional<OpenedSession>& current() const { return current_; }
  /// Compares the open session (or the session that is being opened) with the session `other`, with the default margin
  /// of compare_sessions(). compared() or problem() follows.
  void compare_with(const std::filesystem::path& other);
  [[nodiscard]] const std::optional<ComparedSessions>& compared_sessions() const { return compared_; }
  /// Writes report.html and report.pdf into the open session; exported() or problem() follows.
  void export_reports();
  /// Writes the reports with an order and stores the order in the session. `order`: file with a section [order].
  void export_with_order(const std::filesystem::path& order);
  /// Makes the plan of the open session the plan of the bench, for a new run.
  void use_plan_again();

  /// Returns the figure of the open session, or of the comparison if there is one.
  [[nodiscard]] Plot tod_figure(AxisScale acuity_axis) const;

 signals:
  void listed();
  void opened();
  void compared();
  void exported(const QString& html, const QString& pdf);
  void problem(const QString& sentence);

 private:
  template <typename T>
  void in_background(std::function<Result<T>()> work, std::function<void(Result<T>)> done);
  void compare(const std::filesystem::path& other);

  Workbench& bench_;
  std::vector<SessionEntry> sessions_;
  std::optional<OpenedSession> current_;
  std::optional<ComparedSessions> compared_;
  int opening_ = 0;  ///< sessions being opened as current_
  std::optional<std::filesystem::path> compare_when_opened_;
  JobRunner list_jobs_, jobs_;
};

/// Reads a session with all displayed data. Errors: those of open_session(), report_data() and read_human().
[[nodiscard]] Result<OpenedSession> read_opened_session(const std::filesystem::path& folder);
/// Files of an export.
struct Exported {
  QString html, pdf;
};
/// Writes report.html and report.pdf into the folder of the session, and their hashes into its manifest. With an order
/// (bench/plan/order.h), the first page shows the order, and the session stores it. Any thread. Errors: `io` with the
/// path; `invalid_input` if files of the session were changed.
[[nodiscard]] Result<Exported> export_reports(const OpenedSession& opened,
                                              const std::optional<std::filesystem::path>& order = std::nullopt);
/// Returns the sessions directly in a folder, newest first. Unreadable sessions are left out.
[[nodiscard]] std::vector<SessionEntry> sessions_below(const std::filesystem::path& folder);

}  // namespace todbench
