// SPDX-License-Identifier: GPL-3.0-or-later
// Recorded inputs of a measurement other than its frames. A question is a request of the measurement to its host or its
// target. Each answer is stored with its question.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/recording/frame_stream.h"
#include "tod/measurement/run_controller.h"
#include "tod/presentation/target.h"

namespace todbench {

/// Version of the questions of a measurement and of their order. Each recording states its version. A recording of a
/// different version is not replayed.
inline constexpr std::string_view answers_format = "2";

/// Returns the record of the time of the clock.
[[nodiscard]] Reading clock_answer(Moment why, std::int64_t now_ns);
/// Returns the record of the answer to the question whether the run pauses.
[[nodiscard]] Reading rest_answer(bool rests);
/// Returns the record of the number of frames requested while the target presented a state.
[[nodiscard]] Reading calls_answer(std::int64_t calls);
/// Returns the record of the outcome of a recovery.
[[nodiscard]] Reading recovery_answer(const Result<void>& back);
/// Returns the record that the target requested its state again (Target::asks_again() returned true).
[[nodiscard]] Reading again_answer();
/// Returns the record of a state that was requested from the target, and of its report.
[[nodiscard]] Reading target_answer(const TargetState& set, const Result<PresentedTarget>& said);

/// Replay of the recorded answers to the same questions in the same order. Errors: `invalid_input` for a question that
/// differs from the recorded question, and for all later questions; `disconnected` after the last answer, because there
/// are no further frames. One thread at a time.
class RecordedAnswers {
 public:
  /// `name`: name of the recording in messages.
  RecordedAnswers(std::string name, std::vector<Reading> readings)
      : name_(std::move(name)), readings_(std::move(readings)) {}

  [[nodiscard]] Result<std::int64_t> clock(Moment why);
  [[nodiscard]] Result<bool> rest();
  [[nodiscard]] Result<std::int64_t> calls();
  /// Returns the recorded outcome of the recovery.
  [[nodiscard]] Result<void> recovery();
  /// Returns the recorded report of the target. Errors: `invalid_input` if the target was set differently, because the
  /// frames then show a different state.
  [[nodiscard]] Result<PresentedTarget> target(const TargetState& set);

  /// Returns whether the target requested its state again at this point.
  [[nodiscard]] bool again();

  /// Returns whether every recorded answer was given.
  [[nodiscard]] bool at_end() const { return next_ == readings_.size(); }
  /// Succeeds if all previous questions agree with the recording.
  [[nodiscard]] Result<void> agreed() const;

 private:
  [[nodiscard]] Result<std::string> take(const std::string& tag);
  [[nodiscard]] Result<std::int64_t> take_whole(const std::string& tag);
  /// Reports an answer whose kind differs from the expected kind.
  [[nodiscard]] tl::unexpected<Error> refuse(const std::string& expected, const std::string& found);

  std::string name_;
  std::vector<Reading> readings_;
  std::size_t next_ = 0;
  std::optional<Error> disagreement_;
};

}  // namespace todbench
