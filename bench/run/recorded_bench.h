// SPDX-License-Identifier: GPL-3.0-or-later
// Records a bench while it measures, and opens a bench from a recording.
#pragma once

#include <filesystem>
#include <memory>

#include "bench/devices/devices.h"
#include "bench/run/recorded_answers.h"

namespace todbench {

class FrameStreamWriter;
struct StreamHeader;

/// Returns the header of a recording of this camera that begins now.
[[nodiscard]] StreamHeader header_now(SourceInfo info);

/// Returns the path of the recording of a session.
[[nodiscard]] std::filesystem::path recorded_frames(const std::filesystem::path& session);

/// Starts recording. Appends all inputs of the measurement beyond the plan to the recording of the session. These are
/// frames, failures, reports of the target and answers of the host, each with its question. At the end, the returned
/// writer reports whether the recording is complete on disk. Errors: `io`.
[[nodiscard]] Result<std::shared_ptr<FrameStreamWriter>> record_bench(OpenedBench& bench,
                                                                      const std::filesystem::path& session);

/// A bench that replays a recording.
struct RecordedBench {
  OpenedBench bench;
  std::shared_ptr<const RecordedAnswers> answers;  ///< reports afterwards whether the questions match the recording
};

/// Opens the bench of a session's recording. A measurement with the same questions in the same order receives the same
/// answers, bit for bit; otherwise it fails with `invalid_input`. `pause`: controls pauses of the replay and must
/// outlive the bench; null: the replay never pauses. Errors: `invalid_input` (no recording in the session, a recording
/// that is not one of a measurement, or a different format of answers), `io`.
[[nodiscard]] Result<RecordedBench> open_recorded_bench(const std::filesystem::path& session, const Pause* pause);

}  // namespace todbench
