// SPDX-License-Identifier: GPL-3.0-or-later
// Main window: eight views and a start page, one message line, one state.
#pragma once

#include <QMainWindow>
#include <filesystem>
#include <functional>
#include <optional>
#include <utility>

#include "bench/gui/presenters/align_presenter.h"
#include "bench/gui/presenters/chain_presenter.h"
#include "bench/gui/presenters/history_presenter.h"
#include "bench/gui/presenters/human_presenter.h"
#include "bench/gui/presenters/look_presenter.h"
#include "bench/gui/presenters/measure_presenter.h"
#include "bench/gui/presenters/person_presenter.h"
#include "bench/gui/presenters/plan_presenter.h"
#include "bench/gui/presenters/session_presenter.h"
#include "bench/gui/presenters/workbench.h"
#include "bench/gui/views/theme.h"

class QFrame;
class QLabel;
class QListWidget;
class QPushButton;
class QStackedWidget;

namespace todbench {

class HelpWindow;
class PlanView;

/// View of the window.
enum class View { look, align, plan, measure, human, chain, report, history, start };
/// The views in the list on the left; the start page is opened from the menu.
inline constexpr std::array all_views{View::look,  View::align, View::plan,   View::measure,
                                      View::human, View::chain, View::report, View::history};
/// Returns the label of the view.
[[nodiscard]] QString name_of(View view);

/// Whether the window stores its state and restores it at the next start.
enum class Memory { remember, forget };

/// Window with the list of views, the current view, the message line and the state of the bench.
class MainWindow final : public QMainWindow {
  Q_OBJECT

 public:
  /// Creates the window. Sessions are read from and written to `sessions`.
  MainWindow(const std::filesystem::path& sessions, Memory memory, QWidget* parent = nullptr);
  ~MainWindow() override;

  /// Shows a view.
  void show_view(View view);
  [[nodiscard]] View view() const;
  /// Sets light or dark theme.
  void set_theme(Theme theme);
  /// Function that asks the user before a run or the answers of a person are lost, and returns whether the user
  /// confirmed. `question`: text of the message; `action`: text of the button that confirms. Tests use it to replace
  /// the message box.
  using Confirm = std::function<bool(const QString& question, const QString& action)>;
  void set_confirm(Confirm confirm) { confirm_ = std::move(confirm); }
  /// Opens a session (its folder or session.toml) or a plan (another TOML file); shows an error if the file cannot be
  /// opened.
  void open_path(const std::filesystem::path& path);

  // Access to the presenters, for tests and pictures.
  [[nodiscard]] Workbench& bench() { return bench_; }
  [[nodiscard]] LookPresenter& look() { return look_; }
  [[nodiscard]] AlignPresenter& align() { return align_; }
  [[nodiscard]] PlanPresenter& plan() { return plan_; }
  [[nodiscard]] MeasurePresenter& measure() { return measure_; }
  [[nodiscard]] HumanPresenter& human() { return human_; }
  [[nodiscard]] PersonPresenter& person() { return person_; }
  [[nodiscard]] ChainPresenter& chain() { return chain_; }
  [[nodiscard]] SessionPresenter& sessions() { return sessions_; }
  [[nodiscard]] HistoryPresenter& history() { return history_; }

 protected:
  void closeEvent(QCloseEvent* event) override;
  void dragEnterEvent(QDragEnterEvent* event) override;
  void dropEvent(QDropEvent* event) override;

 private:
  void make_views();
  [[nodiscard]] QWidget* start_page();
  void make_menu();
  void connect_parts();
  void choose_session();
  /// Returns whether the user agrees to lose a running measurement or unfinished answers; true if there are none.
  [[nodiscard]] bool may_end(const QString& action);
  void start_run();
  void abort_run();
  void show_help(const QString& page);
  void show_trouble(const QString& sentence, Remedy remedy);
  /// Shows a message with the remaining time and the possible actions while the run waits for a lost camera.
  void show_camera_away();
  void show_state();
  void recall();
  void remember();

  Memory memory_;
  Workbench bench_;
  LookPresenter look_;
  AlignPresenter align_;
  PlanPresenter plan_;
  MeasurePresenter measure_;
  HumanPresenter human_;
  PersonPresenter person_;
  ChainPresenter chain_;
  SessionPresenter sessions_;
  HistoryPresenter history_;
  Theme theme_ = Theme::light;
  bool first_start_ = false;  ///< no stored state exists
  bool away_ = false;         ///< the message about a lost camera is shown
  Activity last_activity_ = Activity::idle;
  QListWidget* navigation_ = nullptr;
  QStackedWidget* views_ = nullptr;
  PlanView* plan_view_ = nullptr;
  QFrame* message_ = nullptr;
  QLabel* message_text_ = nullptr;
  QPushButton *retry_ = nullptr, *abandon_ = nullptr, *other_camera_ = nullptr;
  QLabel* state_ = nullptr;
  Confirm confirm_;
  HelpWindow* help_ = nullptr;
};

}  // namespace todbench
