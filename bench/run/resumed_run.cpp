// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run/resumed_run.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/devices/reconnecting_source.h"
#include "bench/text/folders.h"

namespace todbench {
namespace {

/// Whether the run is in its second part. Set by the measuring thread, or while that waits for the target.
struct Splice {
  std::atomic<bool> live = false;
};

/// The recorded frames, then those of the camera. Sequence numbers continue.
class SplicedSource final : public FrameSource {
 public:
  SplicedSource(std::unique_ptr<FrameSource> recorded, std::unique_ptr<FrameSource> camera,
                std::shared_ptr<Splice> splice)
      : info_(camera->info()), camera_(std::move(camera)), splice_(std::move(splice)), source_(std::move(recorded)) {}

  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] Result<void> start() override { return present()->start(); }
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds timeout) override {
    if (splice_->live && !switched_) return tl::unexpected(end_of_first_part());
    auto frame = present()->next(timeout);
    // A stop request ended the first part.
    if (!frame && !switched_ && frame.error().code == ErrorCode::interrupted)
      return tl::unexpected(end_of_first_part());
    if (!frame) return frame;
    if (switched_ && !offset_) offset_ = next_sequence_ - frame->sequence;
    frame->sequence += offset_.value_or(0);
    next_sequence_ = std::max(next_sequence_, frame->sequence + 1);
    return frame;
  }
  void stop() override { present()->stop(); }
  [[nodiscard]] Result<std::string> get(const std::string& feature) override { return present()->get(feature); }
  [[nodiscard]] Result<void> set(const std::string& feature, const std::string& value) override {
    return present()->set(feature, value);
  }
  [[nodiscard]] Result<void> correct_nonuniformity() override {
    if (splice_->live && !switched_) return tl::unexpected(end_of_first_part());
    return present()->correct_nonuniformity();
  }

  [[nodiscard]] bool switched() const { return switched_; }
  /// Changes to the camera at the end of the recording.
  [[nodiscard]] Result<void> switch_over() {
    splice_->live = switched_ = true;
    const std::lock_guard lock(mutex_);
    source_ = std::move(camera_);
    return source_->start();
  }

 private:
  static Error end_of_first_part() { return {ErrorCode::disconnected, "the first part of the run ends here"}; }
  [[nodiscard]] std::shared_ptr<FrameSource> present() const {
    const std::lock_guard lock(mutex_);
    return source_;
  }

  SourceInfo info_;
  std::unique_ptr<FrameSource> camera_;  ///< until the change
  std::shared_ptr<Splice> splice_;
  bool switched_ = false;
  std::optional<std::uint64_t> offset_;  ///< of the camera's numbers; modulo 2^64
  std::uint64_t next_sequence_ = 0;
  mutable std::mutex mutex_;  ///< guards the pointer
  std::shared_ptr<FrameSource> source_;
};

/// The recorded reports, then those of the target. The failure that ended the first part is not repeated.
class SplicedTarget final : public Target {
 public:
  SplicedTarget(std::unique_ptr<Target> recorded, std::unique_ptr<Target> target,
                std::shared_ptr<const RecordedAnswers> answers, std::shared_ptr<Splice> splice)
      : recorded_(std::move(recorded)),
        target_(std::move(target)),
        answers_(std::move(answers)),
        splice_(std::move(splice)) {}
  [[nodiscard]] const TargetCapabilities& capabilities() const override { return target_->capabilities(); }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    if (!splice_->live && !answers_->at_end()) {
      auto said = recorded_->present(state, stop);
      if (said || !answers_->at_end() || stop.stop_requested()) return said;
    }
    splice_->live = true;
    return target_->present(state, std::move(stop));
  }
  /// A slip that ended the first part is mended in the second.
  [[nodiscard]] bool asks_again(const std::string& reason) override {
    if (!splice_->live && recorded_->asks_again(reason)) return true;
    return (splice_->live || answers_->at_end()) && target_->asks_again(reason);
  }

 private:
  std::unique_ptr<Target> recorded_, target_;
  std::shared_ptr<const RecordedAnswers> answers_;
  std::shared_ptr<Splice> splice_;
};

/// The recorded answers, then those of the host of the bench.
class SplicedHost final : public RunController {
 public:
  SplicedHost(RecordedBench& recorded, std::unique_ptr<RunController> host, std::shared_ptr<Splice> splice,
              SplicedSource& source)
      : recorded_(std::move(recorded.bench.host)),
        host_(std::move(host)),
        answers_(recorded.answers),
        splice_(std::move(splice)),
        source_(source) {}

  [[nodiscard]] Result<std::int64_t> now_ns(Moment why) override { return present().now_ns(why); }
  [[nodiscard]] Result<bool> rests(std::stop_token stop) override { return present().rests(std::move(stop)); }
  [[nodiscard]] FramesWhilePresenting frames_while_presenting() const override {
    return splice_->live ? host_->frames_while_presenting() : recorded_->frames_while_presenting();
  }
  [[nodiscard]] Result<std::int64_t> asked_while_presenting(std::int64_t calls) override {
    return present().asked_while_presenting(calls);
  }
  [[nodiscard]] bool recovers() const override { return true; }
  [[nodiscard]] Result<void> recover(std::stop_token stop) override {
    if (&present() == recorded_.get()) {
      // A loss that the first part survived. One that ended it is that of the gap.
      if (auto back = recorded_->recover(stop); back || stop.stop_requested()) return back;
    }
    if (!source_.switched()) return source_.switch_over();
    if (host_->recovers()) return host_->recover(std::move(stop));
    return fail(ErrorCode::disconnected,
                "camera " + source_.info().id + " was lost and did not return with the same identity and settings");
  }
  void resumed() override {
    if (splice_->live && host_->recovers()) host_->resumed();
  }

 private:
  RunController& present() {
    if (answers_->at_end()) splice_->live = true;
    return splice_->live ? *host_ : *recorded_;
  }

  std::unique_ptr<RunController> recorded_, host_;
  std::shared_ptr<const RecordedAnswers> answers_;
  std::shared_ptr<Splice> splice_;
  SplicedSource& source_;  ///< of the same bench
};

/// Puts the recorded devices in front of the live ones. Keeps warnings and patience of the live bench.
void splice_in_front(RecordedBench recorded, OpenedBench& live) {
  const auto splice = std::make_shared<Splice>();
  auto source = std::make_unique<SplicedSource>(std::move(recorded.bench.camera), std::move(live.camera), splice);
  live.target = std::make_unique<SplicedTarget>(std::move(recorded.bench.target), std::move(live.target),
                                                recorded.answers, splice);
  live.host = std::make_unique<SplicedHost>(recorded, std::move(live.host), splice, *source);
  live.camera = std::move(source);
  live.simulated = recorded.bench.simulated;
}

/// A GigE Vision camera belongs to a killed program until its heartbeat is over: 3 s by default. Some cameras take the
/// question whether they are free for that heartbeat, so attempts are further apart.
constexpr std::chrono::milliseconds longer_than_a_heartbeat{3500};

/// The resumed run waits for its camera as a run waits for a lost one.
CameraPatience as_after_a_loss(const CameraPlan& camera, const std::function<void(std::string_view)>& on_phase) {
  return {.longest = std::chrono::milliseconds(static_cast<long>(1000 * camera.reconnect_s)),
          .between_attempts = longer_than_a_heartbeat,
          .on_waiting = [on_phase](const Error& reason) {
            if (on_phase) on_phase("waiting for the camera: " + reason.message);
          }};
}

/// A run that is under way holds the claim. A killed program holds it until the system has taken its memory back, which
/// takes a moment on a busy computer.
Result<std::shared_ptr<const FolderClaim>> claim_of_ended_run(const std::filesystem::path& session) {
  constexpr std::chrono::seconds longest_end{2};
  constexpr std::chrono::milliseconds between_attempts{50};
  const auto until = std::chrono::steady_clock::now() + longest_end;
  auto claim = claim_folder(session);
  while (!claim && std::chrono::steady_clock::now() < until) {
    std::this_thread::sleep_for(between_attempts);
    claim = claim_folder(session);
  }
  return claim;
}

}  // namespace

Result<RecordedRun> open_interrupted_run(const std::filesystem::path& session, const Pause* pause,
                                         const Opening& opening, RunModules modules) {
  if (auto claim = claim_of_ended_run(session); !claim)
    return fail(ErrorCode::invalid_input,
                session.string() + ": the run of this session is under way in another program; stop it first");
  TODBENCH_TRY(
      RecordedRun run,
      open_recorded_run(session, pause, {.accept_changed = opening.accept_changed, .accept_cut_off = true}, modules));
  if (run.session.provenance.state == SessionState::complete)
    return fail(ErrorCode::invalid_input,
                session.string() + ": the session is complete, so there is nothing to resume");
  return run;
}

Result<ExperimentOutcome> resume_session(RecordedRun run, ExperimentOptions options, const ExperimentListener& listener,
                                         std::stop_token stop) {
  TODBENCH_TRY(const LoadedPlan loaded, LoadedPlan::of(run.session.plan, run.session.parts));
  options.origin = OriginRecord{.session = std::filesystem::absolute(run.folder).lexically_normal().string(),
                                .manifest_sha256 = run.session.manifest_sha256,
                                .signed_by = "",
                                .then = judged_by(loaded),
                                .now = judged_by(loaded),
                                .resumed = true};
  options.host.camera_patience = as_after_a_loss(loaded.plan().camera, listener.on_phase);
  options.host.on_opened = [&run, &loaded](OpenedBench& live) -> Result<std::string> {
    const SourceInfo recorded = run.recording.bench.camera->info();
    if (auto same = restore_settings(*live.camera, loaded.plan().camera.settings, recorded); !same)
      return fail(ErrorCode::invalid_input, "the session cannot be resumed: " + same.error().message);
    splice_in_front(std::move(run.recording), live);
    return "resumed: the first part of the run is session " + run.folder.string();
  };
  const auto answers = run.recording.answers;
  auto outcome = measure_plan(loaded, options, listener, std::move(stop));
  TODBENCH_TRY_VOID(answers->agreed());
  return outcome;
}

}  // namespace todbench
