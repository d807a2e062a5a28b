// SPDX-License-Identifier: GPL-3.0-or-later
// Goes on with an interrupted session: its recorded part first, then the camera.
#pragma once

#include <filesystem>
#include <stop_token>

#include "bench/run/experiment.h"
#include "bench/run/replay.h"

namespace todbench {

/// Opens an interrupted session to be resumed. Errors: those of open_recorded_run(); `invalid_input` for a session that
/// is complete or whose run is under way in another program.
[[nodiscard]] Result<RecordedRun> open_interrupted_run(const std::filesystem::path& session, const Pause* pause,
                                                       const Opening& opening = {},
                                                       RunModules modules = RunModules::no);

/// Measures the plan of an interrupted session to its end, into a new session. The recorded frames and answers give the
/// first part again, with the same trials; at their end the camera takes over as after a loss: the plate is located
/// again, the presentation is repeated, and the gap is an interruption of the run (a new segment). Camera, settings and
/// temperature scale must be those of the recording. A camera that cannot be opened yet is waited for as after a loss,
/// at most `reconnect_s` of the plan. The new session records the frames of both parts, so that it can be resumed or
/// replayed in turn. Errors: those of measure_plan(); `invalid_input` for another camera.
[[nodiscard]] Result<ExperimentOutcome> resume_session(RecordedRun run, ExperimentOptions options,
                                                       const ExperimentListener& listener, std::stop_token stop);

}  // namespace todbench
