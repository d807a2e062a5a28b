// SPDX-License-Identifier: GPL-3.0-or-later
// Measures a session again from its recorded frames.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bench/run/experiment.h"
#include "bench/run/recorded_bench.h"
#include "bench/session/open_session.h"

namespace todbench {

/// Result of a replay.
struct ReplayOutcome {
  ExperimentOutcome run;  ///< outcome of the run with a new session folder
  bool same_trials = false;
  /// Whether the fits of the measured curve are equal. Empty if the session ended before its fit, or if its program
  /// version computed the intervals of graded answers without the positions in the picture.
  std::optional<bool> same_fits;
  std::vector<std::string> accepted_changes{};  ///< accepted changes of the replayed session
};

/// Permission to start the programs that a session names.
enum class RunModules { no, yes };

/// Returns the observer of a plan for OriginRecord, without a package.
[[nodiscard]] JudgedBy judged_by(const LoadedPlan& loaded);

/// A recorded session that is ready to be measured again.
struct RecordedRun {
  std::filesystem::path folder;
  Session session;
  RecordedBench recording;
  /// Plan of the session without recording, physical measures and their limits. Only the frames of the trials are
  /// recorded, so the physical measures cannot be repeated.
  Plan plan;
  std::vector<std::string> warnings;
};
/// Opens a recorded session. `pause`: as open_recorded_bench(). Errors: `invalid_input` (not a session, no recording,
/// changed files that `opening` does not accept, modules that may not run).
[[nodiscard]] Result<RecordedRun> open_recorded_run(const std::filesystem::path& session, const Pause* pause,
                                                    const Opening& opening, RunModules modules);

/// Measures again with the plan and the frames of the session, simulates the twin again, and compares trials and fits
/// byte for byte. An interrupted session is replayed to the end of its frames and compared to the end of its trials.
/// Losses that the run survived are replayed too. `accept_changed` of `opening` accepts changed files; the new session
/// records this. Errors: `invalid_input` (not a session, no recording, modules that may not run, changed files, or a
/// recording by a program version with other questions), those of measure_plan().
[[nodiscard]] Result<ReplayOutcome> replay_session(const std::filesystem::path& session,
                                                   const ExperimentOptions& options, const ExperimentListener& listener,
                                                   std::stop_token stop, const Opening& opening = {},
                                                   RunModules modules = RunModules::no);

}  // namespace todbench
