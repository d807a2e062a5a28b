// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/recording/recorded_source.h"

#include <atomic>
#include <chrono>
#include <utility>

#include "acquisition/base/host_clock.h"

namespace todbench {
namespace {

class RecordedSource : public FrameSource {
 public:
  RecordedSource(Recording recording, Playback playback)
      : recording_(std::move(recording)),
        playback_(playback),
        scale_(std::make_shared<const RadiometricScale>(recording_.info.scale)) {}

  [[nodiscard]] const SourceInfo& info() const override { return recording_.info; }

  [[nodiscard]] Result<void> start() override {
    if (dead_) return tl::unexpected(end());
    if (!running_.exchange(true)) position_ = failure_ = next_sequence_ = 0;
    return {};
  }

  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds) override {
    if (dead_) return tl::unexpected(end());
    if (!running_) return fail(ErrorCode::interrupted, recording_.info.id + " is stopped");
    if (fails_now(FailedCall::next)) return tl::unexpected(recording_.failures[failure_++].error);
    if (position_ >= recording_.frame_count) {
      dead_ = true;
      return tl::unexpected(end());
    }
    auto recorded = recording_.read(position_);
    if (!recorded) {
      dead_ = true;
      // Not `disconnected`: that is the end of a recording, which is no failure.
      const bool wrong = recorded.error().code == ErrorCode::invalid_input;
      return fail("reading frame " + std::to_string(position_) + " of " + recording_.info.id,
                  with_code(wrong ? ErrorCode::invalid_input : ErrorCode::integrity, recorded.error()));
    }
    return frame(std::move(*recorded));
  }

  void stop() override { running_ = false; }

  [[nodiscard]] Result<std::string> get(const std::string& feature) override {
    const auto setting = recording_.info.settings.find(feature);
    if (setting != recording_.info.settings.end()) return setting->second;
    return fail(ErrorCode::invalid_input, "the recording does not contain the feature " + feature);
  }

  [[nodiscard]] Result<void> set(const std::string& feature, const std::string& value) override {
    return fail(ErrorCode::invalid_input, "setting " + feature + "=" + value + ": a recording cannot be changed");
  }

  [[nodiscard]] Result<void> correct_nonuniformity() override {
    if (fails_now(FailedCall::correct_nonuniformity)) return tl::unexpected(recording_.failures[failure_++].error);
    if (playback_ == Playback::replay) return {};
    return fail(ErrorCode::invalid_input, "a recording cannot correct its non-uniformity");
  }

 private:
  /// Whether the recorded camera failed at this point in the same call.
  [[nodiscard]] bool fails_now(FailedCall call) const {
    if (playback_ != Playback::replay || failure_ >= recording_.failures.size()) return false;
    const RecordedFailure& failure = recording_.failures[failure_];
    return failure.before_frame <= position_ && failure.call == call;
  }

  [[nodiscard]] Frame frame(RecordedFrame recorded) {
    Frame result;
    result.counts = std::move(recorded.counts);
    result.sequence = recorded.sequence.value_or(next_sequence_);
    next_sequence_ = result.sequence + 1;
    ++position_;
    result.device_time_ns = recorded.device_time_ns;
    result.host_time_ns = playback_ == Playback::replay ? recorded.host_time_ns : monotonic_ns();
    result.numbering = recorded.numbering;
    result.correction = recorded.correction;
    result.since_correction_s = recorded.since_correction_s;
    result.significant_bits = recorded.significant_bits.value_or(recording_.info.significant_bits);
    result.scale = scale_;
    const bool as_stated = result.counts.cols == recording_.info.width && result.counts.rows == recording_.info.height;
    result.status = recorded.status == FrameStatus::complete && !as_stated ? FrameStatus::wrong_size : recorded.status;
    return result;
  }

  [[nodiscard]] Error end() const {
    return {ErrorCode::disconnected, recording_.info.id + " ends after " + std::to_string(position_) + " frames"};
  }

  Recording recording_;
  Playback playback_;
  std::shared_ptr<const RadiometricScale> scale_;
  std::uint64_t position_ = 0;
  std::uint64_t next_sequence_ = 0;
  std::size_t failure_ = 0;  ///< index of the next failure
  bool dead_ = false;
  std::atomic<bool> running_ = false;  ///< the only member that stop() accesses from another thread
};

}  // namespace

std::unique_ptr<FrameSource> recorded_source(Recording recording, Playback playback) {
  return std::make_unique<RecordedSource>(std::move(recording), playback);
}

}  // namespace todbench
