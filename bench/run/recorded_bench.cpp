// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run/recorded_bench.h"

#include <string>
#include <utility>

#include "acquisition/base/try.h"
#include "acquisition/recording/frame_stream.h"
#include "acquisition/recording/recording_camera.h"
#include "bench/session/provenance.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

constexpr const char* format_key = "answers_format";
constexpr const char* target_key = "target";
constexpr const char* sets_shift_key = "target_sets_shift";
constexpr const char* simulated_key = "simulated";
constexpr const char* comes_back_key = "camera_comes_back";
constexpr const char* frames_while_presenting_key = "frames_while_presenting";

std::string yes_no(bool value) {
  return value ? "yes" : "no";
}

/// A recording being written. If the disk rejects an answer, the recording ends and the next frame fails.
using Stream = std::shared_ptr<FrameStreamWriter>;

class RecordingHost final : public RunController {
 public:
  RecordingHost(std::unique_ptr<RunController> host, Stream stream)
      : host_(std::move(host)), stream_(std::move(stream)) {}

  [[nodiscard]] Result<std::int64_t> now_ns(Moment why) override {
    auto now = host_->now_ns(why);
    if (now) (void)stream_->append_reading(clock_answer(why, *now));
    return now;
  }
  [[nodiscard]] Result<bool> rests(std::stop_token stop) override {
    auto rests = host_->rests(std::move(stop));
    if (rests) (void)stream_->append_reading(rest_answer(*rests));
    return rests;
  }
  [[nodiscard]] FramesWhilePresenting frames_while_presenting() const override {
    return host_->frames_while_presenting();
  }
  [[nodiscard]] Result<std::int64_t> asked_while_presenting(std::int64_t calls) override {
    auto asked = host_->asked_while_presenting(calls);
    if (asked) (void)stream_->append_reading(calls_answer(*asked));
    return asked;
  }
  [[nodiscard]] bool recovers() const override { return host_->recovers(); }
  [[nodiscard]] Result<void> recover(std::stop_token stop) override {
    auto back = host_->recover(std::move(stop));
    (void)stream_->append_reading(recovery_answer(back));
    return back;
  }
  void resumed() override { host_->resumed(); }

 private:
  std::unique_ptr<RunController> host_;
  Stream stream_;
};

class RecordingTarget final : public Target {
 public:
  RecordingTarget(std::unique_ptr<Target> target, Stream stream)
      : target_(std::move(target)), stream_(std::move(stream)) {}
  [[nodiscard]] const TargetCapabilities& capabilities() const override { return target_->capabilities(); }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    auto said = target_->present(state, std::move(stop));
    (void)stream_->append_reading(target_answer(state, said));
    return said;
  }
  [[nodiscard]] bool asks_again(const std::string& reason) override {
    const bool again = target_->asks_again(reason);
    if (again) (void)stream_->append_reading(again_answer());
    return again;
  }

 private:
  std::unique_ptr<Target> target_;
  Stream stream_;
};

class ReplayedHost final : public RunController {
 public:
  ReplayedHost(std::shared_ptr<RecordedAnswers> answers, FramesWhilePresenting frames, bool recovers,
               const Pause* pause)
      : answers_(std::move(answers)), frames_(frames), recovers_(recovers), pause_(pause) {}

  [[nodiscard]] Result<std::int64_t> now_ns(Moment why) override { return answers_->clock(why); }
  [[nodiscard]] Result<bool> rests(std::stop_token stop) override {
    while (pause_ != nullptr && !stop.stop_requested() && pause_->rest(stop)) continue;
    return answers_->rest();
  }
  [[nodiscard]] FramesWhilePresenting frames_while_presenting() const override { return frames_; }
  [[nodiscard]] Result<std::int64_t> asked_while_presenting(std::int64_t) override { return answers_->calls(); }
  [[nodiscard]] bool recovers() const override { return recovers_; }
  [[nodiscard]] Result<void> recover(std::stop_token) override { return answers_->recovery(); }
  void resumed() override {}

 private:
  std::shared_ptr<RecordedAnswers> answers_;
  FramesWhilePresenting frames_;
  bool recovers_;
  const Pause* pause_;
};

/// Shows no picture, because its effect is in the frames. Returns the recorded reports.
class ReplayedTarget final : public Target {
 public:
  ReplayedTarget(std::shared_ptr<RecordedAnswers> answers, TargetCapabilities capabilities)
      : answers_(std::move(answers)), capabilities_(std::move(capabilities)) {}
  [[nodiscard]] const TargetCapabilities& capabilities() const override { return capabilities_; }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped before the target was presented");
    return answers_->target(state);
  }
  [[nodiscard]] bool asks_again(const std::string&) override { return answers_->again(); }

 private:
  std::shared_ptr<RecordedAnswers> answers_;
  TargetCapabilities capabilities_;
};

/// Checks that this version understands the recorded answers. The first versions wrote answers without their questions.
Result<void> check_format(const std::filesystem::path& file, const std::map<std::string, std::string>& annotations) {
  if (!annotations.contains(sets_shift_key))
    return fail(ErrorCode::invalid_input, file.string() + ": not the recording of a measurement");
  const auto found = annotations.find(format_key);
  const std::string format = found == annotations.end() ? "1" : found->second;
  if (format == answers_format) return {};
  return fail(ErrorCode::invalid_input, file.string() + ": expected a measurement with answers in format " +
                                            std::string(answers_format) + ", found format " + one_line(format) +
                                            ". Replay it with the version of the program that measured it");
}

}  // namespace

std::filesystem::path recorded_frames(const std::filesystem::path& session) {
  return session / "frames" / "camera.todrec";
}

StreamHeader header_now(SourceInfo info) {
  return {.info = std::move(info), .created_utc = utc_now(), .created_host_ns = monotonic_ns(), .annotations = {}};
}

Result<std::shared_ptr<FrameStreamWriter>> record_bench(OpenedBench& bench, const std::filesystem::path& session) {
  const std::filesystem::path file = recorded_frames(session);
  std::error_code problem;
  std::filesystem::create_directories(file.parent_path(), problem);
  if (problem) return fail(ErrorCode::io, file.parent_path().string() + ": cannot be created: " + problem.message());
  StreamHeader header = header_now(bench.camera->info());
  header.annotations = {
      {format_key, std::string(answers_format)},
      {target_key, bench.target->capabilities().description},
      {sets_shift_key, yes_no(bench.target->capabilities().sets_shift)},
      {simulated_key, yes_no(bench.simulated)},
      {comes_back_key, yes_no(bench.host->recovers())},
      {frames_while_presenting_key, yes_no(bench.host->frames_while_presenting() != FramesWhilePresenting::leave)}};
  TODBENCH_TRY(auto writer, FrameStreamWriter::create(file, header));
  const auto stream = std::make_shared<FrameStreamWriter>(std::move(writer));
  bench.camera = recording_camera(std::move(bench.camera), stream);
  bench.target = std::make_unique<RecordingTarget>(std::move(bench.target), stream);
  bench.host = std::make_unique<RecordingHost>(std::move(bench.host), stream);
  return stream;
}

Result<RecordedBench> open_recorded_bench(const std::filesystem::path& session, const Pause* pause) {
  const std::filesystem::path file = recorded_frames(session);
  std::error_code problem;
  if (!std::filesystem::exists(file, problem)) {
    return fail(ErrorCode::invalid_input, session.string() +
                                              ": this session has no recorded frames. Measure with [measurement] "
                                              "record_frames or --record-frames");
  }
  TODBENCH_TRY(auto stream, open_frame_stream(file));
  auto& annotations = stream.header.annotations;
  TODBENCH_TRY_VOID(check_format(file, annotations));
  const auto answers = std::make_shared<RecordedAnswers>(file.string(), std::move(stream.readings));
  const auto frames =
      annotations[frames_while_presenting_key] == "yes" ? FramesWhilePresenting::repeat : FramesWhilePresenting::leave;
  RecordedBench out{.bench = {}, .answers = answers};
  out.bench.camera = recorded_source(std::move(stream.recording), Playback::replay);
  out.bench.target = std::make_unique<ReplayedTarget>(
      answers,
      TargetCapabilities{.description = annotations[target_key], .sets_shift = annotations[sets_shift_key] == "yes"});
  out.bench.simulated = annotations[simulated_key] == "yes";
  out.bench.host = std::make_unique<ReplayedHost>(answers, frames, annotations[comes_back_key] == "yes", pause);
  return out;
}

}  // namespace todbench
