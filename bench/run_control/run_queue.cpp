// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run_control/run_queue.h"

#include <charconv>
#include <utility>

#include "bench/serve/live_run.h"
#include "bench/session/json_output.h"
#include "bench/session/session_clock.h"

namespace todbench {
namespace {

Json points_of(const std::optional<TodCurve>& curve) {
  return curve ? curve_json(*curve, {}, {})["points"] : Json();
}

Json question_of(std::uint64_t number, const OperatorRequest& request) {
  Json steps = Json::array();
  for (const OperatorStep& step : request.steps) steps.push_back(sentence(step));
  return {{"number", number}, {"steps", steps}};
}

}  // namespace

std::string_view to_string(QueuedRunState state) {
  switch (state) {
    case QueuedRunState::queued:
      return "queued";
    case QueuedRunState::running:
      return "running";
    case QueuedRunState::finished:
      return "finished";
    case QueuedRunState::stopped:
      return "stopped";
    case QueuedRunState::failed:
      return "failed";
  }
  return "failed";
}

struct RunQueue::Entry {
  Entry(std::uint64_t number, RequestedRun asked) : id(number), run(std::move(asked)) {}

  const std::uint64_t id;
  const RequestedRun run;
  const std::string queued_utc = utc_text(HostClocks::Wall::clock::now());
  std::stop_source stop{};
  // The lock of the queue guards the following members.
  std::uint64_t version = 1;
  QueuedRunState state = QueuedRunState::queued;
  std::filesystem::path folder{};
  std::shared_ptr<const LivePages> pages{};
  Json points{}, twin_points{};
  std::uint64_t questions = 0;
  Json question{};
  std::optional<OperatorAnswer> answer{};
  std::optional<std::string> reason{}, verdict{};
  std::optional<int> code{};

  [[nodiscard]] bool over() const { return state != QueuedRunState::queued && state != QueuedRunState::running; }
  [[nodiscard]] Json json() const {
    const auto text_or_null = [](const std::optional<std::string>& text) { return text ? Json(*text) : Json(); };
    return {{"id", std::to_string(id)},
            {"name", run.plan.plan().name},
            {"mode", to_string(run.mode)},
            {"seed", run.plan.plan().seed},
            {"state", to_string(state)},
            {"over", over()},
            {"queued_utc", queued_utc},
            {"session", folder.empty() ? Json() : Json(folder.string())},
            {"live", pages ? Json::parse(pages->state_json, nullptr, false) : Json()},
            {"question", question},
            {"points", points},
            {"twin_points", twin_points},
            {"verdict", text_or_null(verdict)},
            {"reason", text_or_null(reason)},
            {"exit_code", code ? Json(*code) : Json()}};
  }
};

RunQueue::RunQueue(std::filesystem::path sessions, std::function<void()> changed)
    : sessions_(std::move(sessions)), changed_(std::move(changed)) {
  worker_ = std::jthread([this](const std::stop_token& end) { work(end); });
}

RunQueue::~RunQueue() {
  worker_.request_stop();
  const std::lock_guard lock(mutex_);
  waiting_.clear();
  if (current_) current_->stop.request_stop();
}

void RunQueue::touch(Entry& entry) {
  ++entry.version;
}

Result<std::string> RunQueue::add(RequestedRun run) {
  std::string id;
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.size() >= most_waiting)
      return fail(ErrorCode::not_found, "the queue is full: " + std::to_string(most_waiting) + " runs wait");
    const auto entry = std::make_shared<Entry>(++last_id_, std::move(run));
    entries_[entry->id] = entry;
    waiting_.push_back(entry);
    for (auto old = entries_.begin(); entries_.size() > most_kept && old != entries_.end();)
      old = old->second->over() ? entries_.erase(old) : std::next(old);
    id = std::to_string(entry->id);
  }
  wake_.notify_all();
  changed_();
  return id;
}

std::shared_ptr<RunQueue::Entry> RunQueue::find(const std::string& id) const {
  std::uint64_t number = 0;
  const auto [end, problem] = std::from_chars(id.data(), id.data() + id.size(), number);
  if (problem != std::errc() || end != id.data() + id.size()) return nullptr;
  const auto found = entries_.find(number);
  return found == entries_.end() ? nullptr : found->second;
}

std::optional<RunSnapshot> RunQueue::snapshot(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto entry = find(id);
  if (!entry) return std::nullopt;
  return RunSnapshot{entry->version, to_line(entry->json()), entry->over()};
}

Json RunQueue::list() const {
  const std::lock_guard lock(mutex_);
  Json runs = Json::array();
  for (const auto& [id, entry] : entries_) runs.push_back(entry->json());
  return {{"runs", runs}};
}

Result<void> RunQueue::answer(const std::string& id, std::optional<std::uint64_t> number, OperatorAnswer answer) {
  {
    const std::lock_guard lock(mutex_);
    const auto entry = find(id);
    if (!entry) return fail(ErrorCode::not_found, "no such run");
    if (entry->question.is_null()) return fail(ErrorCode::invalid_input, "the run asks nothing");
    if (number && *number != entry->questions) {
      return fail(ErrorCode::invalid_input,
                  "the run asks request " + std::to_string(entry->questions) + ", not " + std::to_string(*number));
    }
    entry->answer = answer;
  }
  wake_.notify_all();
  return {};
}

Result<void> RunQueue::stop(const std::string& id) {
  {
    const std::lock_guard lock(mutex_);
    const auto entry = find(id);
    if (!entry) return fail(ErrorCode::not_found, "no such run");
    entry->stop.request_stop();
    if (std::erase(waiting_, entry) > 0) {
      entry->state = QueuedRunState::stopped;
      entry->reason = "removed from the queue";
      entry->code = exit_code(ErrorCode::interrupted);
      touch(*entry);
    }
  }
  changed_();
  return {};
}

std::optional<std::filesystem::path> RunQueue::folder(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto entry = find(id);
  return entry ? std::optional(entry->folder) : std::nullopt;
}

std::shared_ptr<const LivePages> RunQueue::pages(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto entry = find(id);
  return entry ? entry->pages : nullptr;
}

bool RunQueue::is_running() const {
  const std::lock_guard lock(mutex_);
  return current_ != nullptr;
}

void RunQueue::work(const std::stop_token& end) {
  for (;;) {
    std::shared_ptr<Entry> entry;
    {
      std::unique_lock lock(mutex_);
      if (!wake_.wait(lock, end, [this] { return !waiting_.empty(); }) || end.stop_requested()) return;
      entry = waiting_.front();
      waiting_.pop_front();
      entry->state = QueuedRunState::running;
      touch(*entry);
      current_ = entry;
    }
    changed_();
    run(entry);
    {
      const std::lock_guard lock(mutex_);
      current_ = nullptr;
    }
    changed_();
  }
}

Result<OperatorAnswer> RunQueue::ask(Entry& entry, const OperatorRequest& request, const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  entry.answer.reset();
  entry.question = question_of(++entry.questions, request);
  touch(entry);
  lock.unlock();
  changed_();
  lock.lock();
  const bool answered = wake_.wait(lock, stop, [&entry] { return entry.answer.has_value(); });
  entry.question = Json();
  touch(entry);
  if (!answered) return fail(ErrorCode::interrupted, "stopped while waiting for the operator");
  return *entry.answer;
}

Result<ExperimentOutcome> RunQueue::run_shown(const std::shared_ptr<Entry>& entry) {
  const LoadedPlan& plan = entry->run.plan;
  LiveCurve curve(plan.plan());
  std::uint64_t shown = 0;
  const auto show = [&](std::shared_ptr<const LivePages> pages) {
    const auto fitted = curve.latest();
    const bool grown = fitted && fitted->version != shown;
    Json points = grown ? points_of(fitted->measured) : Json(), twin = grown ? points_of(fitted->twin) : Json();
    if (grown) shown = fitted->version;
    {
      const std::lock_guard lock(mutex_);
      const bool same = !grown && entry->pages && entry->pages->state_json == pages->state_json;
      if (grown) {
        entry->points = std::move(points);
        entry->twin_points = std::move(twin);
      }
      entry->pages = std::move(pages);
      if (same) return;
      touch(*entry);
    }
    changed_();
  };
  LiveRun live(show, curve, plan.plan());
  ExperimentListener listener;
  listener.on_session = [&](const std::filesystem::path& folder) {
    const std::lock_guard lock(mutex_);
    entry->folder = folder;
    touch(*entry);
  };
  listener.on_trial = [&](SessionCurve which, const Trial& trial, const Patch&) { curve.add(which, trial); };
  ExperimentOptions options{.folder = sessions_ / session_folder_name(plan.plan().name),
                            .existing = ExistingFolder::number};
  options.host.ask_operator = [&](const OperatorRequest& request, const std::stop_token& stop) {
    std::string steps;
    for (const OperatorStep& step : request.steps) steps += (steps.empty() ? "" : "\n") + sentence(step);
    live.ask(steps);
    auto answer = ask(*entry, request, stop);
    live.ask("");
    return answer;
  };
  auto outcome = entry->run.mode == RunMode::measure
                     ? measure_plan(plan, options, live.listening(listener), entry->stop.get_token())
                     : simulate_plan(plan, options, live.listening(listener), entry->stop.get_token());
  const bool whole = outcome && !outcome->ended_by;
  live.end(whole     ? "the run is finished"
           : outcome ? "the trials so far are in the session"
                     : "the run has no result",
           whole ? std::optional(std::string(to_string(outcome->verdict.decision))) : std::nullopt,
           whole     ? std::nullopt
           : outcome ? std::optional(outcome->ended_by->message)
                     : std::optional(outcome.error().message));
  return outcome;
}

void RunQueue::finish(Entry& entry, const Result<ExperimentOutcome>& outcome) {
  const std::lock_guard lock(mutex_);
  if (!outcome) {
    entry.state = outcome.error().code == ErrorCode::interrupted ? QueuedRunState::stopped : QueuedRunState::failed;
    entry.reason = outcome.error().message;
    entry.code = exit_code(outcome.error().code);
  } else if (outcome->ended_by) {
    entry.state = QueuedRunState::stopped;
    entry.reason = outcome->ended_by->message;
    entry.code = exit_code(outcome->ended_by->code);
  } else {
    entry.state = QueuedRunState::finished;
    entry.verdict = to_string(outcome->verdict.decision);
    entry.code = exit_code(outcome->verdict.decision);
    entry.points = points_of(outcome->curve);
    entry.twin_points = points_of(outcome->twin);
  }
  touch(entry);
}

void RunQueue::run(const std::shared_ptr<Entry>& entry) {
  const auto outcome = run_shown(entry);
  finish(*entry, outcome);
}

}  // namespace todbench
