// How a run begins and ends in its folder, whatever happens between.
#pragma once

#include <string>

#include "bench/run/experiment.h"

namespace todbench {

/// The folder of a run and who is told of it. Borrows both.
struct SessionFrame {
  SessionFolder& folder;
  const ExperimentListener& listener;
};

/// A phase, and a sentence, into the log and to the listener.
void phase(SessionFolder& folder, const ExperimentListener& listener, const std::string& text);
void note(SessionFolder& folder, const ExperimentListener& listener, const std::string& sentence);

/// Creates the folder, takes room for the end and writes what is known before the first frame; `provenance` gets the
/// time at which the session began. Errors: as SessionFolder::create(), and `io` when the disk has no such room.
[[nodiscard]] Result<SessionFolder> begin_session(const LoadedPlan& loaded, const ExperimentOptions& options,
                                                  Provenance& provenance);

/// The session is over before there is a curve: leaves a valid folder, hands the reason on.
[[nodiscard]] tl::unexpected<Error> abandon(const SessionFrame& frame, const Plan& plan, const Provenance& provenance,
                                            Error error);

/// State, verdict, report and manifest. The result is the first thing that was refused; what follows it is written
/// nevertheless as far as there is room.
[[nodiscard]] Result<void> close_session(const SessionFrame& frame, const Provenance& provenance,
                                         const Verdict& verdict, const std::optional<Error>& ended_by);

/// The last step of every run that has a curve: judges it, writes the results, the state, the report and the manifest.
/// A disk that refuses ends the session early; what does not fit is left out, the results still reach the caller.
[[nodiscard]] ExperimentOutcome concluded(ExperimentOutcome outcome, const Plan& plan, const SessionFrame& frame,
                                          const Provenance& provenance);

}  // namespace todbench
