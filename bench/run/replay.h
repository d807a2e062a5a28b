// A session measured again from its recorded frames.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/run/experiment.h"
#include "bench/session/open_session.h"

namespace todbench {

struct ReplayOutcome {
  ExperimentOutcome run;  ///< its session folder is a new one
  bool same_trials = false;
  /// Of the measured curve; nothing where the session ended before it was fitted, or is of a version whose intervals of
  /// graded answers knew no places in the picture.
  std::optional<bool> same_fits;
  std::vector<std::string> accepted_changes{};  ///< of the session that was replayed
};

/// Whether the programs that a session names are started here.
enum class RunModules { no, yes };

/// Measures again with the plan of the session and the frames in it, simulates the twin again, and compares trials and
/// fits byte for byte. A session that was cut off is replayed as far as its frames go, and compared as far as its
/// trials go; `accept_changed` of `opening` takes files that were changed, and the new session says so. A loss that the
/// run survived is replayed like everything else. Errors: `invalid_input` (not a session, no recording in it, modules
/// that may not run, files that were changed since, a recording that another version of the program made and that this
/// one would ask otherwise), those of measure_plan().
[[nodiscard]] Result<ReplayOutcome> replay_session(const std::filesystem::path& session,
                                                   const ExperimentOptions& options, const ExperimentListener& listener,
                                                   std::stop_token stop, const Opening& opening = {},
                                                   RunModules modules = RunModules::no);

}  // namespace todbench
