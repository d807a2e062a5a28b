// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/measure_presenter.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bench/gui/presenters/text_of.h"
#include "bench/plan/descriptions.h"
#include "bench/plan/plan_options.h"
#include "bench/report/tod_figures.h"
#include "bench/run/replay.h"
#include "bench/run/report_data.h"
#include "bench/run/resumed_run.h"
#include "tod/schedule/schedule.h"

namespace todbench {
namespace {

constexpr int collect_period_ms = 100;
constexpr qint64 least_fit_period_ms = 700;
constexpr std::size_t recent_trials = 60;
constexpr int most_notes = 200;

/// Sizes of the triangles in the camera's view; errors of unreadable plates are left to the run.
std::vector<double> sizes_of(const Plan& plan) {
  std::vector<double> sizes_mrad;
  for (const std::string& name : plan.target.plates) {
    const Result<TargetPlate> plate = load_plate(name);
    if (!plate) continue;
    for (const PlateTriangle& triangle : plate->triangles)
      sizes_mrad.push_back(triangle.size_mm / plan.target.distance_m);
  }
  return sizes_mrad;
}

/// Requests to the operator for the presentations of the plan; 0: unknown, or no operator. Physical measures ask
/// further ones.
std::size_t requests_of(const Plan& plan) {
  if (plan.target.kind != TargetKind::prompt || plan.schedule.kind != ScheduleKind::constant) return 0;
  if (!(plan.camera.ifov_mrad > 0)) return 0;
  std::vector<TargetPlate> plates;
  for (const std::string& name : plan.target.plates) {
    auto plate = load_plate(name);
    if (!plate) return 0;
    plates.push_back(*std::move(plate));
  }
  const auto states = constant_stimuli(stimuli_options(plan, plates, plan.camera.ifov_mrad, Side::measured),
                                       RandomStream(plan.seed, "schedule"));
  std::size_t requests = 0;
  std::optional<TargetState> last;
  for (const TargetState& state : states) {
    if (!request_between(last, state).steps.empty()) ++requests;
    last = state;
  }
  return requests;
}

}  // namespace

MeasurePresenter::MeasurePresenter(Workbench& bench, QObject* parent) : QObject(parent), bench_(bench) {
  plan_ = bench.plan();
  connect(&bench_, &Workbench::plan_changed, this, [this] {
    if (state_ != RunState::idle || outcome_) return;
    plan_ = bench_.plan();
    emit updated();
  });
  // If devices cannot be prepared, or a stop comes before they are ready, the run ends before it starts.
  connect(&bench_, &Workbench::activity_changed, this, [this] {
    if (bench_.activity() == Activity::idle) conclude(fail(ErrorCode::interrupted, "the run did not start"));
  });
  timer_.setInterval(collect_period_ms);
  connect(&timer_, &QTimer::timeout, this, &MeasurePresenter::collect);
}

ExperimentListener MeasurePresenter::listener() {
  ExperimentListener out;
  out.on_phase = [this](std::string_view text) {
    bench_.post([this, phase = text_of(text)] {
      phase_ = phase;
      done_ = planned_ = 0;
      in_phase_.invalidate();
      emit updated();
    });
  };
  out.on_note = [this](std::string_view text) {
    bench_.post([this, sentence = text_of(text)] {
      notes_ << sentence;
      if (notes_.size() > most_notes) notes_.removeFirst();
      emit updated();
    });
  };
  out.on_session = [this](const std::filesystem::path& folder) { bench_.post([this, folder] { folder_ = folder; }); };
  out.on_open = [this](const SourceInfo& info) { bench_.feed().open(info); };
  out.on_frame = [this](const Frame& frame) {
    bench_.feed().put(frame);
    const std::lock_guard lock(inbox_.mutex);
    inbox_.frame_came = true;
  };
  out.on_lost = [this](const SourceInfo& camera, std::chrono::milliseconds patience) {
    if (patience.count() <= 0) return;
    {
      const std::lock_guard lock(inbox_.mutex);
      inbox_.frame_came = false;
    }
    bench_.post([this, camera, patience] { camera_lost(camera, patience); });
  };
  out.on_wait = [this](const std::optional<TargetWait>& wait) {
    bench_.post([this, text = wait ? QString::fromStdString(sentence(*wait)) : QString()] {
      waiting_ = text;
      emit updated();
    });
  };
  out.on_progress = [this](std::size_t done, std::size_t planned) {
    const std::lock_guard lock(inbox_.mutex);
    inbox_.progress = {done, planned};
  };
  out.on_trial = [this](SessionCurve curve, const Trial& trial, const Patch& patch) {
    cv::Mat1f kelvin;
    patch.kelvin.convertTo(kelvin, CV_32F);
    const std::lock_guard lock(inbox_.mutex);
    inbox_.trials.push_back({curve, trial, std::move(kelvin), patch.noise_k});
  };
  return out;
}

ExperimentHost MeasurePresenter::host() {
  ExperimentHost out;
  out.pause = &pause_;
  out.ask_operator = [this](const OperatorRequest& request, const std::stop_token& stop) {
    desk_->clear();
    bench_.post([this, request] {
      request_ = request;
      if (!std::holds_alternative<CheckAgain>(request.steps.front())) ++requests_;
      emit updated();
      emit operator_needed();
    });
    auto answer = desk_->wait(stop);
    bench_.post([this] {
      request_.reset();
      emit updated();
    });
    return answer;
  };
  return out;
}

void MeasurePresenter::begin(const Plan& plan) {
  plan_ = plan;
  sizes_mrad_ = sizes_of(plan);
  requests_ = 0;
  planned_requests_ = requests_of(plan);
  since_begin_.start();
  phase_ = "starting";
  notes_.clear();
  request_.reset();
  waiting_.clear();
  done_ = planned_ = presented_ = 0;
  folder_.clear();
  trials_.clear();
  twin_trials_.clear();
  recent_.clear();
  fitted_ = 0;
  measured_.reset();
  twin_.reset();
  outcome_.reset();
  same_.reset();
  away_.reset();
  pause_.resume();
  {
    const std::lock_guard lock(inbox_.mutex);
    inbox_.trials.clear();
    inbox_.progress.reset();
  }
  ++run_;
  running_fit_ = std::make_shared<RunningFit>(plan_);
  set_state(RunState::running);
  timer_.start();
  since_fit_.start();
}

void MeasurePresenter::start() {
  if (state_ != RunState::idle) return;
  begin(bench_.plan());
  replayed_.reset();
  resumed_.reset();
  const std::filesystem::path folder = bench_.sessions_folder() / session_folder_name(plan_.name);
  bench_.run(Activity::measuring, [this, run = run_, folder](const Plan& plan, const std::stop_token& stop) {
    const ExperimentOptions options{.folder = folder, .existing = ExistingFolder::number, .host = host()};
    return hand_over(run, measure_plan(plan, options, listener(), stop), {});
  });
  emit updated();
}

void MeasurePresenter::replay(const std::filesystem::path& session, const Plan& plan) {
  if (state_ != RunState::idle) return;
  begin(plan);
  replayed_ = session;
  resumed_.reset();
  const std::filesystem::path folder = bench_.sessions_folder() / session_folder_name(plan.name + "-replay");
  bench_.run_without_devices(
      Activity::replaying, [this, run = run_, session, folder](const Plan&, const std::stop_token& stop) {
        const ExperimentOptions options{.folder = folder, .existing = ExistingFolder::number, .host = host()};
        const auto replayed = replay_session(session, options, listener(), stop);
        if (!replayed) return hand_over(run, tl::unexpected(replayed.error()), {});
        return hand_over(run, replayed->run, replayed->same_trials && replayed->same_fits.value_or(true));
      });
  emit updated();
}

void MeasurePresenter::resume_run(const std::filesystem::path& session, const Plan& plan) {
  if (state_ != RunState::idle) return;
  bench_.set_plan(plan);
  begin(plan);
  replayed_.reset();
  resumed_ = session;
  const std::filesystem::path folder = bench_.sessions_folder() / session_folder_name(plan.name + "-resumed");
  bench_.run(Activity::measuring, [this, run = run_, session, folder](const Plan&, const std::stop_token& stop) {
    const ExperimentOptions options{.folder = folder, .existing = ExistingFolder::number, .host = host()};
    auto opened = open_interrupted_run(session, options.host.pause);
    if (!opened) return hand_over(run, tl::unexpected(opened.error()), {});
    return hand_over(run, resume_session(*std::move(opened), options, listener(), stop), {});
  });
  emit updated();
}

void MeasurePresenter::again() {
  if (replayed_) {
    replay(*replayed_, plan_);
  } else if (resumed_) {
    resume_run(*resumed_, plan_);
  } else {
    start();
  }
}

Result<void> MeasurePresenter::hand_over(std::uint64_t run, const Result<ExperimentOutcome>& outcome,
                                         std::optional<bool> same) {
  bench_.post([this, run, outcome, same] {
    if (run != run_) return;
    same_ = same;
    conclude(outcome);
  });
  if (!outcome) return tl::unexpected(outcome.error());
  if (outcome->ended_by) return tl::unexpected(*outcome->ended_by);
  return {};
}

void MeasurePresenter::pause() {
  if (state_ != RunState::running) return;
  pause_.pause();
  set_state(RunState::paused);
}

void MeasurePresenter::resume() {
  if (state_ != RunState::paused) return;
  pause_.resume();
  in_phase_.invalidate();
  set_state(RunState::running);
}

void MeasurePresenter::abort() {
  if (state_ == RunState::idle) return;
  set_state(RunState::stopping);
  bench_.stop();
}

void MeasurePresenter::camera_lost(const SourceInfo& camera, std::chrono::milliseconds patience) {
  if (state_ == RunState::idle) return;
  away_ = Away{QString::fromStdString(camera.model + ", serial number " + camera.serial),
               std::chrono::steady_clock::now() + patience};
  bench_.report_health(DeviceHealth::lost);
  emit updated();
}

QString MeasurePresenter::camera_away() const {
  if (!away_) return {};
  const auto left = std::chrono::ceil<std::chrono::seconds>(away_->until - std::chrono::steady_clock::now());
  return QString(
             "Camera %1 was lost. The run waits for it: %2 s left. It continues by itself when the camera is back. "
             "All data so far are kept in any case.")
      .arg(away_->camera)
      .arg(std::max<qint64>(0, left.count()));
}

void MeasurePresenter::set_state(RunState state) {
  if (state_ == state) return;
  state_ = state;
  emit state_changed();
  emit updated();
}

void MeasurePresenter::collect() {
  std::vector<JudgedTrial> arrived;
  std::optional<std::pair<std::size_t, std::size_t>> progress;
  bool back = false;
  {
    const std::lock_guard lock(inbox_.mutex);
    arrived.swap(inbox_.trials);
    progress = std::exchange(inbox_.progress, std::nullopt);
    back = inbox_.frame_came;
  }
  if (away_) {
    if (back) {
      away_.reset();
      in_phase_.invalidate();  // the time of the absence does not count for the time left
      bench_.report_health(DeviceHealth::in_use);
    }
    emit updated();  // the time left
  }
  if (arrived.empty() && !progress) return;
  const std::size_t newest = arrived.size() > recent_trials ? arrived.size() - recent_trials : 0;
  for (std::size_t i = newest; i < arrived.size(); ++i) recent_.push_front(arrived[i]);
  while (recent_.size() > recent_trials) recent_.pop_back();
  for (auto& judged : arrived) {
    if (judged.curve == SessionCurve::main) {
      trials_.push_back(std::move(judged));
    } else {
      twin_trials_.push_back(std::move(judged.trial));
    }
  }
  if (progress) {
    std::tie(done_, planned_) = *progress;
    presented_ = done_;
    if (!in_phase_.isValid()) {
      in_phase_.start();
      done_at_start_ = done_;
    }
  }
  if (!fitting_ && since_fit_.elapsed() > least_fit_period_ms) fit();
  emit updated();
}

void MeasurePresenter::fit() {
  if (trials_.size() + twin_trials_.size() == fitted_) return;
  fitted_ = trials_.size() + twin_trials_.size();
  fitting_ = true;
  std::vector<Trial> measured;
  measured.reserve(trials_.size());
  for (const auto& judged : trials_) measured.push_back(judged.trial);
  // Only one job at a time uses `fit`.
  jobs_.start([this, run = run_, fit = running_fit_, measured = std::move(measured),
               twin = twin_trials_](const std::stop_token& stop) {
    bench_.post([this, run, measured_curve = fit->curve_of(measured, stop), twin_curve = fit->curve_of(twin, stop)] {
      fitting_ = false;
      since_fit_.start();
      if (run != run_ || outcome_ || state_ == RunState::idle) return;
      measured_ = measured_curve;
      if (twin_curve) twin_ = twin_curve;
      emit updated();
    });
  });
}

void MeasurePresenter::conclude(const Result<ExperimentOutcome>& outcome) {
  if (state_ == RunState::idle) return;
  collect();
  timer_.stop();
  away_.reset();
  request_.reset();
  waiting_.clear();
  if (outcome) {
    outcome_ = *outcome;
    folder_ = outcome->folder;
    measured_ = outcome->curve;
    twin_ = outcome->twin;
    if (!outcome->ended_by) done_ = planned_ = presented_;
    phase_ = outcome->ended_by ? "ended early: " + QString::fromStdString(outcome->ended_by->message)
                               : "verdict: " + text_of(decision_word(outcome->verdict));
    if (same_)
      phase_ = (*same_ ? "✓ replayed: trials and fits are the same, byte for byte; "
                       : "✗ replayed: the answers DIFFER from those of the session; ") +
               phase_;
  } else {
    phase_ = "ended: " + QString::fromStdString(outcome.error().message);
  }
  set_state(RunState::idle);
  emit updated();
  if (outcome_) emit finished(QString::fromStdString(folder_.string()));
}

QString MeasurePresenter::under_way() const {
  if (state_ == RunState::idle) return {};
  const qint64 minutes = since_begin_.elapsed() / 60'000;
  const QString length = minutes < 1    ? "less than a minute"
                         : minutes < 60 ? QString("%1 min").arg(minutes)
                                        : QString("%1 h %2 min").arg(minutes / 60).arg(minutes % 60);
  return "A run of " + length + " is under way";
}

QString MeasurePresenter::request_number() const {
  if (!request_) return {};
  QString text = QString("Request %1").arg(requests_);
  if (planned_requests_ >= requests_ && planned_requests_ > 0) text += QString(" of %1").arg(planned_requests_);
  return text;
}

QString MeasurePresenter::next_step() const {
  if (request_) {
    QStringList steps;
    for (const auto& step : request_->steps) {
      const QString words = QString::fromStdString(sentence(step));
      steps << words.left(1).toUpper() + words.mid(1);
    }
    return steps.join('\n');
  }
  switch (state_) {
    case RunState::paused:
      return "Paused. Press Resume to continue.";
    case RunState::stopping:
      return "Stopping";
    case RunState::running:
      return waiting_.isEmpty() ? QString() : "No action needed. The bench waits for the target.";
    case RunState::idle:
      break;
  }
  return outcome_ || !phase_.isEmpty() ? QString() : "Press Start. The bench then measures by itself.";
}

QString MeasurePresenter::time_left() const {
  if (state_ != RunState::running || away_ || !in_phase_.isValid() || done_ <= done_at_start_ + 2 || planned_ < done_)
    return {};
  const double per_presentation = in_phase_.elapsed() / 1000.0 / static_cast<double>(done_ - done_at_start_);
  const int seconds = static_cast<int>(std::lround(per_presentation * static_cast<double>(planned_ - done_)));
  return seconds < 60 ? QString("%1 s left").arg(seconds)
                      : QString("%1 min %2 s left").arg(seconds / 60).arg(seconds % 60);
}

Plot MeasurePresenter::psychometric_plot(double set_delta_t_k) const {
  const TodPoint* measured = measured_ ? point_at(*measured_, set_delta_t_k) : nullptr;
  const TodPoint* twin = twin_ ? point_at(*twin_, set_delta_t_k) : nullptr;
  Plot plot = psychometric_figure("live", {"measured", measured}, {"simulated", twin}, plan_.fit.form, sizes_mrad_);
  plot.title = "ΔT = " + QString::number(set_delta_t_k).toStdString() + " K";
  return plot;
}

Plot MeasurePresenter::tod_plot(AxisScale acuity_axis) const {
  std::vector<DrawnLimit> limits;
  for (const auto& limit : plan_.limits.acuity) limits.push_back({limit.delta_t_k, limit.least_acuity_per_mrad});
  const bool twin = twin_.has_value();
  const TodCurve* beside = twin ? &*twin_ : predicted_ ? &*predicted_ : nullptr;
  return with_acuity_axis(
      tod_figure({"measured", measured_ ? &*measured_ : nullptr}, {twin ? "simulated" : "predicted", beside}, limits),
      acuity_axis);
}

}  // namespace todbench
