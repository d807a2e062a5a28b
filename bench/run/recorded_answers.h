// SPDX-License-Identifier: GPL-3.0-or-later
// Answers that a measurement got besides its frames, as recorded: each with its question.
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

/// Version of the questions of a measurement and their order. A recording states its version; another one is not
/// replayed.
inline constexpr std::string_view answers_format = "2";

[[nodiscard]] Reading clock_answer(Moment why, std::int64_t now_ns);
[[nodiscard]] Reading rest_answer(bool rests);
[[nodiscard]] Reading calls_answer(std::int64_t calls);
[[nodiscard]] Reading recovery_answer(const Result<void>& back);
/// The target asks for its state again. Recorded only if it does.
[[nodiscard]] Reading again_answer();
[[nodiscard]] Reading target_answer(const TargetState& set, const Result<PresentedTarget>& said);

/// Replays the recorded answers in order, to the same questions in the same order. A question that differs from the
/// recorded one is `invalid_input`, and so are all later ones; after the last answer it is `disconnected`, because the
/// frames end there too. One thread at a time.
class RecordedAnswers {
 public:
  /// `name`: name of the recording in messages.
  RecordedAnswers(std::string name, std::vector<Reading> readings)
      : name_(std::move(name)), readings_(std::move(readings)) {}

  [[nodiscard]] Result<std::int64_t> clock(Moment why);
  [[nodiscard]] Result<bool> rest();
  [[nodiscard]] Result<std::int64_t> calls();
  /// The recorded outcome.
  [[nodiscard]] Result<void> recovery();
  /// The recorded report of the target. Errors: `invalid_input` if the target was set otherwise, because the frames
  /// show another target.
  [[nodiscard]] Result<PresentedTarget> target(const TargetState& set);

  /// Returns whether the target asked for its state again at this point.
  [[nodiscard]] bool again();

  /// Returns whether every recorded answer was given.
  [[nodiscard]] bool at_end() const { return next_ == readings_.size(); }
  /// Succeeds if all questions so far were the recorded ones.
  [[nodiscard]] Result<void> agreed() const;

 private:
  [[nodiscard]] Result<std::string> take(const std::string& tag);
  [[nodiscard]] Result<std::int64_t> take_whole(const std::string& tag);
  /// Reports an answer that differs from the expected kind.
  [[nodiscard]] tl::unexpected<Error> refuse(const std::string& expected, const std::string& found);

  std::string name_;
  std::vector<Reading> readings_;
  std::size_t next_ = 0;
  std::optional<Error> disagreement_;
};

}  // namespace todbench
