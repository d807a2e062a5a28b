// SPDX-License-Identifier: GPL-3.0-or-later
// Continuation of an interrupted session: its recorded part first, then the camera.
#pragma once

#include <filesystem>
#include <stop_token>

#include "bench/run/experiment.h"
#include "bench/run/replay.h"

namespace todbench {

/// Opens an interrupted session to be resumed. Errors: those of open_recorded_run(); `invalid_input` for a session that
/// is complete or that another program is still measuring.
[[nodiscard]] Result<RecordedRun> open_interrupted_run(const std::filesystem::path& session, const Pause* pause,
                                                       const Opening& opening = {},
                                                       RunModules modules = RunModules::no);

/// Measures the plan of an interrupted session to its end, into a new session. The recorded frames and answers
/// reproduce the first part with the same trials. After this part, the run continues with the camera as after a loss:
/// the plate is located again, the presentation is repeated, and the gap is an interruption of the run (a new segment).
/// Camera, settings and temperature scale must match the recording. If the camera cannot be opened, the function waits
/// for the camera as after a loss, at most `reconnect_s` of the plan. The new session records the frames of both parts
/// and can therefore be resumed or replayed. Errors: those of measure_plan(); `invalid_input` for a different camera.
[[nodiscard]] Result<ExperimentOutcome> resume_session(RecordedRun run, ExperimentOptions options,
                                                       const ExperimentListener& listener, std::stop_token stop);

}  // namespace todbench
