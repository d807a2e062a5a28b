// What a measurement was told beside its frames, as the recording keeps it: every answer with its question.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/recording/frame_stream.h"
#include "tod/measurement/measurement_host.h"
#include "tod/presentation/target.h"

namespace todbench {

/// Of what a measurement asks and in which order it may ask it. A recording says which one it has; no other is
/// replayed.
inline constexpr std::string_view answers_format = "2";

[[nodiscard]] Reading clock_answer(Moment why, std::int64_t now_ns);
[[nodiscard]] Reading rest_answer(bool rests);
[[nodiscard]] Reading calls_answer(std::int64_t calls);
[[nodiscard]] Reading recovery_answer(const Result<void>& back);
[[nodiscard]] Reading target_answer(const TargetState& set, const Result<PresentedTarget>& said);

/// The answers of then, one after the other, to whoever asks the same questions in the same order. Another question
/// than that of then is `invalid_input`, and so is every one after it; behind the last answer it is `disconnected`: the
/// frames end there too. One thread at a time.
class RecordedAnswers {
 public:
  /// `name` is what messages call the recording.
  RecordedAnswers(std::string name, std::vector<Reading> readings)
      : name_(std::move(name)), readings_(std::move(readings)) {}

  [[nodiscard]] Result<std::int64_t> clock(Moment why);
  [[nodiscard]] Result<bool> rest();
  [[nodiscard]] Result<std::int64_t> calls();
  /// The outcome of then.
  [[nodiscard]] Result<void> recovery();
  /// What the target said then. A target that was set otherwise then is another question: the frames show something
  /// else.
  [[nodiscard]] Result<PresentedTarget> target(const TargetState& set);

  /// Success while every question was that of then.
  [[nodiscard]] Result<void> agreed() const;

 private:
  [[nodiscard]] Result<std::string> take(const std::string& tag);
  [[nodiscard]] Result<std::int64_t> take_whole(const std::string& tag);
  /// The answer just taken is not what was expected.
  [[nodiscard]] tl::unexpected<Error> refuse(const std::string& expected, const std::string& found);

  std::string name_;
  std::vector<Reading> readings_;
  std::size_t next_ = 0;
  std::optional<Error> disagreement_;
};

}  // namespace todbench
