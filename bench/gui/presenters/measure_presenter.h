// SPDX-License-Identifier: GPL-3.0-or-later
// Running measurement: progress, answers, curves.
#pragma once

#include <QElapsedTimer>
#include <QImage>
#include <QObject>
#include <QString>
#include <QStringList>
#include <QTimer>
#include <chrono>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "bench/gui/presenters/operator_requests.h"
#include "bench/gui/presenters/workbench.h"
#include "bench/report/plot.h"
#include "bench/run/experiment.h"
#include "bench/run/judged_trial.h"
#include "bench/run/running_fit.h"

namespace todbench {

/// State of the run.
enum class RunState { idle, running, paused, stopping };

/// Presenter that runs one measurement at a time through measure_plan(). Used in the window's thread.
class MeasurePresenter final : public QObject {
  Q_OBJECT

 public:
  explicit MeasurePresenter(Workbench& bench, QObject* parent = nullptr);

  /// Measures the plan of the workbench into a new session folder.
  void start();
  /// Replays the recorded frames of a session with the plan `plan` into a new session folder.
  void replay(const std::filesystem::path& session, const Plan& plan);
  /// Continues a run that ended early, in a new session folder (resume_session()). The plan of the session becomes the
  /// plan of the bench.
  void resume_run(const std::filesystem::path& session, const Plan& plan);
  /// Repeats the last start(), replay() or resume_run().
  void again();
  /// Pauses before the next presentation.
  void pause();
  /// Ends the pause.
  void resume();
  /// Ends the run within a second; existing results are kept.
  void abort();
  /// Reports that the request of operator_request() is fulfilled.
  void operator_done() { desk_->answer(OperatorAnswer::done); }

  [[nodiscard]] RunState state() const { return state_; }
  /// Returns the current phase in words.
  [[nodiscard]] QString phase() const { return phase_; }
  /// Returns the number of completed presentations of this phase.
  [[nodiscard]] std::size_t done() const { return done_; }
  /// Returns the number of planned presentations of this phase.
  [[nodiscard]] std::size_t planned() const { return planned_; }
  /// Returns "1 min 12 s left", from the presentations of this phase; empty if unknown.
  [[nodiscard]] QString time_left() const;
  /// Returns "A run of 3 h 10 min is under way"; empty: no run.
  [[nodiscard]] QString under_way() const;
  /// Returns "Request 7 of 24" while the run waits for the operator; the total is stated only for a constant schedule.
  [[nodiscard]] QString request_number() const;
  /// Returns the request to the operator for which the run waits; empty: the run does not wait.
  [[nodiscard]] const std::optional<OperatorRequest>& operator_request() const { return request_; }
  /// Returns the state of the target for which the run waits, with requested and reached values; empty: the run does
  /// not wait.
  [[nodiscard]] const QString& waiting() const { return waiting_; }
  /// Returns the next step of the operator in a few words: the open request, or that no action is needed.
  [[nodiscard]] QString next_step() const;
  /// Returns the event and the remaining time while the run waits for a lost camera; otherwise empty.
  [[nodiscard]] QString camera_away() const;
  /// Returns the notes of the run, one sentence each.
  [[nodiscard]] const QStringList& notes() const { return notes_; }
  /// Returns the session folder of the run.
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

  /// Returns the session to which the answers of a person to trials() belong: the session of the run, or the replayed
  /// session if all its answers were reproduced.
  [[nodiscard]] const std::filesystem::path& judged_session() const {
    return replayed_ && same_.value_or(false) ? *replayed_ : folder_;
  }

  /// Returns the plan of the session that was replayed last. Empty if the last run used the camera.
  [[nodiscard]] std::optional<Plan> replayed_plan() const {
    return replayed_ && outcome_ ? std::optional(plan_) : std::nullopt;
  }

  /// Return the curves of the camera and of its twin: during the run the latest fits, afterwards the results of the
  /// session.
  [[nodiscard]] const std::optional<TodCurve>& measured() const { return measured_; }
  [[nodiscard]] const std::optional<TodCurve>& twin() const { return twin_; }
  /// Sets the curve predicted by the simulated sensor, which is shown until trials of the twin arrive.
  void set_predicted(std::optional<TodCurve> predicted) { predicted_ = std::move(predicted); }
  /// Returns the result of the last run; empty before its end.
  [[nodiscard]] const std::optional<ExperimentOutcome>& outcome() const { return outcome_; }
  /// Returns, after a replay, whether trials and fits equal the trials and fits of the session byte for byte.
  [[nodiscard]] std::optional<bool> same_as_recorded() const { return same_; }
  /// Returns the trials of the camera.
  [[nodiscard]] const std::vector<JudgedTrial>& trials() const { return trials_; }
  /// Returns the last answers for both curves, newest first.
  [[nodiscard]] const std::deque<JudgedTrial>& recent() const { return recent_; }

  /// Returns the set contrasts of the plan, in its order.
  [[nodiscard]] std::vector<double> contrasts() const { return plan_.target.delta_t_k; }
  /// Returns the psychometric functions at a contrast.
  [[nodiscard]] Plot psychometric_plot(double set_delta_t_k) const;
  /// Returns the TOD curves.
  [[nodiscard]] Plot tod_plot(AxisScale acuity_axis) const;

 signals:
  /// Displayed values have changed; at most ten times a second.
  void updated();
  void state_changed();
  /// The run begins to wait for the operator.
  void operator_needed();
  /// The session is complete and closed.
  void finished(const QString& folder);

 private:
  /// Data from the device thread for the window.
  struct Inbox {
    std::mutex mutex;
    std::vector<JudgedTrial> trials;
    std::optional<std::pair<std::size_t, std::size_t>> progress;
    bool frame_came = false;
  };
  /// A lost camera that may come back.
  struct Away {
    QString camera;
    std::chrono::steady_clock::time_point until;
  };

  [[nodiscard]] ExperimentListener listener();
  [[nodiscard]] ExperimentHost host();
  void begin(const Plan& plan);
  /// Passes the end of a run to the window. Returns the reason for an early end as the error of the job.
  [[nodiscard]] Result<void> hand_over(std::uint64_t run, const Result<ExperimentOutcome>& outcome,
                                       std::optional<bool> same);
  void set_state(RunState state);
  void camera_lost(const SourceInfo& camera, std::chrono::milliseconds patience);
  void collect();
  void fit();
  void conclude(const Result<ExperimentOutcome>& outcome);

  Workbench& bench_;
  Plan plan_;
  std::vector<double> sizes_mrad_;  ///< sizes of the plates of the plan
  RunState state_ = RunState::idle;
  QString phase_, waiting_;
  std::optional<OperatorRequest> request_;
  QStringList notes_;
  std::size_t done_ = 0, planned_ = 0, done_at_start_ = 0;
  std::size_t presented_ = 0;  ///< presentations in the last phase that counts presentations
  QElapsedTimer in_phase_, since_fit_, since_begin_;
  std::size_t requests_ = 0, planned_requests_ = 0;  ///< requests to the operator; 0 planned: unknown
  std::filesystem::path folder_;
  std::vector<JudgedTrial> trials_;
  std::vector<Trial> twin_trials_;
  std::deque<JudgedTrial> recent_;
  std::size_t fitted_ = 0;
  bool fitting_ = false;
  std::shared_ptr<RunningFit> running_fit_;  // of this run
  std::uint64_t run_ = 0;
  std::optional<TodCurve> measured_, twin_, predicted_;
  std::optional<ExperimentOutcome> outcome_;
  std::optional<bool> same_;
  std::optional<Away> away_;
  std::optional<std::filesystem::path> replayed_;  ///< empty: the last run used the camera
  std::optional<std::filesystem::path> resumed_;   ///< session whose run was continued by the last run
  Pause pause_;
  std::shared_ptr<OperatorRequests> desk_ = std::make_shared<OperatorRequests>();
  Inbox inbox_;
  QTimer timer_;
  JobRunner jobs_;
};

}  // namespace todbench
