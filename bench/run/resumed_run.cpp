// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run/resumed_run.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/devices/reconnecting_source.h"
#include "bench/twin/module_chain.h"

namespace todbench {
namespace {

/// Whether the run is in its second part. Set by the measuring thread, or while that waits for the target.
struct Splice {
  std::atomic<bool> live = false;
};

/// The recorded frames, then those of the camera. Sequence numbers continue.
class SplicedSource final : public FrameSource {
 public:
  SplicedSource(std::unique_ptr<FrameSource> recorded, std::shared_ptr<ReconnectingSource> camera,
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

  /// Changes to the camera at the end of the recording; after that, waits for a camera that was lost.
  [[nodiscard]] Result<void> recover(std::stop_token stop) {
    if (switched_) return camera_->recover(std::move(stop));
    splice_->live = switched_ = true;
    const std::lock_guard lock(mutex_);
    source_ = camera_;
    return source_->start();
  }

 private:
  static Error end_of_first_part() { return {ErrorCode::disconnected, "the first part of the run ends here"}; }
  [[nodiscard]] std::shared_ptr<FrameSource> present() const {
    const std::lock_guard lock(mutex_);
    return source_;
  }

  SourceInfo info_;
  std::shared_ptr<ReconnectingSource> camera_;
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
              SplicedSource& source, std::shared_ptr<ReconnectingSource> camera)
      : recorded_(std::move(recorded.bench.host)),
        host_(std::move(host)),
        answers_(recorded.answers),
        splice_(std::move(splice)),
        source_(source),
        camera_(std::move(camera)) {}

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
    return source_.recover(std::move(stop));
  }
  void resumed() override {
    if (splice_->live) camera_->confirm_registration();
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
  std::shared_ptr<ReconnectingSource> camera_;
};

/// The camera of the plan without waiting for its return: that is added here.
Result<OpenedBench> open_live_bench(const LoadedPlan& loaded, const ExperimentOptions& options,
                                    const ExperimentListener& listener, const SourceInfo& recorded,
                                    std::stop_token stop) {
  Plan plan = loaded.plan();
  plan.camera.reconnect_s = 0;
  TODBENCH_TRY(const LoadedPlan without, loaded.with(std::move(plan)));
  if (listener.on_phase) listener.on_phase("opening " + loaded.plan().camera.id);
  auto bench = open_bench(without, std::move(stop), options.host, listener.on_phase, listener.on_wait);
  if (!bench) return bench;
  if (auto same = restore_settings(*bench->camera, loaded.plan().camera.settings, recorded); !same)
    return fail(ErrorCode::invalid_input, "the session cannot be resumed: " + same.error().message);
  return bench;
}

OpenedBench spliced(RecordedBench recorded, OpenedBench live, const Plan& plan) {
  const auto splice = std::make_shared<Splice>();
  const auto patience = std::chrono::milliseconds(static_cast<long>(plan.camera.reconnect_s * 1000));
  const auto camera = std::make_shared<ReconnectingSource>(
      std::move(live.camera), [id = plan.camera.id] { return camera_registry().open(id); },
      ReconnectionOptions{.patience = patience, .settings = plan.camera.settings});
  auto source = std::make_unique<SplicedSource>(std::move(recorded.bench.camera), camera, splice);
  OpenedBench bench;
  bench.simulated = recorded.bench.simulated;
  bench.patience = patience;
  bench.warnings = std::move(live.warnings);
  bench.target = std::make_unique<SplicedTarget>(std::move(recorded.bench.target), std::move(live.target),
                                                 recorded.answers, splice);
  bench.host = std::make_unique<SplicedHost>(recorded, std::move(live.host), splice, *source, camera);
  bench.camera = std::move(source);
  return bench;
}

}  // namespace

Result<ExperimentOutcome> resume_session(const std::filesystem::path& session, ExperimentOptions options,
                                         const ExperimentListener& listener, std::stop_token stop,
                                         const Opening& opening, RunModules modules) {
  TODBENCH_TRY(RecordedRun run,
               open_recorded_run(session, options.host.pause,
                                 {.accept_changed = opening.accept_changed, .accept_cut_off = true}, modules));
  if (run.session.provenance.state == SessionState::complete)
    return fail(ErrorCode::invalid_input,
                session.string() + ": the session is complete, so there is nothing to resume");
  Plan plan = run.session.plan;
  plan.measurement.record_frames = false;
  TODBENCH_TRY(const LoadedPlan loaded, LoadedPlan::of(std::move(plan), run.session.parts));
  const auto today = std::chrono::floor<std::chrono::days>(std::chrono::system_clock::now());
  if (auto valid = check_calibration(loaded.plan(), today); !valid) return tl::unexpected(valid.error());
  EffectPlanner planner;
  TODBENCH_TRY(ExperimentInputs inputs, experiment_inputs(loaded, planner));
  TODBENCH_TRY(OpenedBench live, open_live_bench(loaded, options, listener, run.recording.bench.camera->info(), stop));
  inputs.warnings.push_back("resumed: the first part of the run is session " + session.string());
  OriginRecord origin{.session = std::filesystem::absolute(session).lexically_normal().string(),
                      .manifest_sha256 = run.session.manifest_sha256,
                      .signed_by = "",
                      .then = judged_by(loaded),
                      .now = judged_by(loaded),
                      .resumed = true};
  options.origin = std::move(origin);
  const auto answers = run.recording.answers;
  auto outcome = measure_on_bench(loaded, inputs, spliced(std::move(run.recording), std::move(live), loaded.plan()),
                                  options, listener, std::move(stop));
  if (auto agreed = answers->agreed(); !agreed) return tl::unexpected(agreed.error());
  return outcome;
}

}  // namespace todbench
