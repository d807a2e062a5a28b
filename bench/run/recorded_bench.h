// A bench that is recorded while it measures, and one that comes out of such a recording.
#pragma once

#include <filesystem>
#include <memory>

#include "bench/run/devices.h"
#include "bench/run/recorded_answers.h"

namespace todbench {

class FrameStreamWriter;

/// Where the recording of a session is.
[[nodiscard]] std::filesystem::path recorded_frames(const std::filesystem::path& session);

/// From now on everything that the measurement learns from the bench beside what the plan says is appended to the
/// recording of the session: every frame, every failure, everything that the target said, and every answer of the host,
/// each with what was asked. What is returned is to be asked at the end whether the recording is on the disk as it was
/// written. `io`.
[[nodiscard]] Result<std::shared_ptr<FrameStreamWriter>> record_bench(OpenedBench& bench,
                                                                      const std::filesystem::path& session);

/// A bench of then.
struct RecordedBench {
  OpenedBench bench;
  std::shared_ptr<const RecordedAnswers> answers;  ///< tells afterwards whether the questions were those of then
};

/// The bench as the recording of a session knows it. A measurement that asks it in the same order gets the same
/// answers, bit for bit; one that asks otherwise fails with `invalid_input`. `pause`: lets the replay rest; null: it
/// never does; outlives the bench. Errors: `invalid_input` (no recording in the session, not one of a measurement, or
/// one with answers in another format), `io`.
[[nodiscard]] Result<RecordedBench> open_recorded_bench(const std::filesystem::path& session, const Pause* pause);

}  // namespace todbench
