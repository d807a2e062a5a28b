// SPDX-License-Identifier: GPL-3.0-or-later
// Start and end of a run in its folder, after success and failure.
#pragma once

#include <string>

#include "bench/run/experiment.h"

namespace todbench {

/// References to the folder of a run and to its listener, which must outlive this object.
struct OpenSession {
  SessionFolder& folder;
  const ExperimentListener& listener;
};

/// Reports a phase to the log and the listener.
void phase(SessionFolder& folder, const ExperimentListener& listener, const std::string& text);
/// Reports a sentence to the log and the listener.
void note(SessionFolder& folder, const ExperimentListener& listener, const std::string& sentence);

/// Creates the folder, reserves disk space for the end, and writes all facts that are known before the first frame.
/// Sets the start time in `provenance`. Errors: those of SessionFolder::create(); `io` if the disk has too little
/// space.
[[nodiscard]] Result<SessionFolder> begin_session(const LoadedPlan& loaded, const ExperimentOptions& options,
                                                  Provenance& provenance);

/// Adds a note if the last self-test of this program on this computer failed.
void note_failed_selftest(const OpenSession& open, const Provenance& provenance);

/// Ends a session without a curve, completes its folder, and returns the reason.
[[nodiscard]] tl::unexpected<Error> abandon(const OpenSession& open, const Plan& plan, const Provenance& provenance,
                                            Error error);

/// Writes state, verdict, report and manifest. Returns the first error; later files are still written if there is
/// space.
[[nodiscard]] Result<void> close_session(const OpenSession& open, const Provenance& provenance, const Verdict& verdict,
                                         const std::optional<Error>& ended_by);

/// Concludes a run with a curve: judges the curve and writes results, state, report and manifest. If a write fails, the
/// session ends early: files that do not fit are left out, and the caller still receives the results.
[[nodiscard]] ExperimentOutcome concluded(ExperimentOutcome outcome, const Plan& plan, const OpenSession& open,
                                          const Provenance& provenance);

}  // namespace todbench
