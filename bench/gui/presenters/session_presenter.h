// Sessions on disk: list, open, compare, export, run again.
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
  QString unit;     ///< in the plan's words, else the camera's model; "simulation" where there is none
  QString serial;   ///< of the camera; empty: there is none
  QString verdict;  ///< "pass", "fail", "inconclusive"; empty: there is none that the manifest vouches for
};

/// The sessions whose serial number, unit, name, date, verdict or state has every word of `filter` in it, in any case.
[[nodiscard]] std::vector<SessionEntry> matching(const std::vector<SessionEntry>& sessions, const QString& filter);

/// A session as values.
struct OpenedSession {
  std::filesystem::path folder;
  QString name;
  Session session;
  ReportData report;
  std::optional<HumanRecord> human;
  bool recorded = false;  ///< the frames are in it: it can be replayed
};

/// Two sessions side by side.
struct ComparedSessions {
  QString a, b;
  TodCurve curve_a, curve_b;
  Comparison comparison;
};

/// Reads and writes in the background, in the order in which it is asked. In the window's thread.
class SessionPresenter final : public QObject {
  Q_OBJECT

 public:
  explicit SessionPresenter(Workbench& bench, QObject* parent = nullptr);

  /// Lists the sessions of the workbench's folder, newest first; listed() follows.
  void refresh();
  [[nodiscard]] const std::vector<SessionEntry>& sessions() const { return sessions_; }
  /// Reads a session; opened() or problem() follows.
  void open(const std::filesystem::path& folder);
  [[nodiscard]] const std::optional<OpenedSession>& current() const { return current_; }
  /// The session that is open, or the one that is being opened, against another with the margin of its plan; compared()
  /// or problem() follows.
  void compare_with(const std::filesystem::path& other);
  [[nodiscard]] const std::optional<ComparedSessions>& compared_sessions() const { return compared_; }
  /// Writes report.html and report.pdf into the session that is open; exported() or problem() follows.
  void export_reports();
  /// Puts the plan of the session that is open back on the bench, for another run.
  void use_plan_again();

  /// Of the session that is open, or of the comparison when there is one.
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
  int opening_ = 0;  ///< sessions that are on their way to be current_
  std::optional<std::filesystem::path> compare_when_opened_;
  JobRunner list_jobs_, jobs_;
};

/// Reads a session with everything that is shown of it. Errors: as open_session(), report_data(), read_human().
[[nodiscard]] Result<OpenedSession> read_opened_session(const std::filesystem::path& folder);
struct Exported {
  QString html, pdf;
};
/// Writes report.html and report.pdf into the session's folder and their sums into its manifest. Any thread. `io` with
/// the path; `invalid_input` when files of the session were changed.
[[nodiscard]] Result<Exported> export_reports(const OpenedSession& opened);
/// Sessions directly below a folder, newest first; unreadable ones are left out.
[[nodiscard]] std::vector<SessionEntry> sessions_below(const std::filesystem::path& folder);

}  // namespace todbench
