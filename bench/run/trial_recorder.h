// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the trials and presentations of a measurement into its session as soon as they are made.
#pragma once

#include <stop_token>
#include <vector>

#include "bench/devices/devices.h"
#include "bench/devices/experiment_host.h"
#include "bench/run/session_end.h"
#include "bench/twin/module_chain.h"
#include "tod/measurement/measurement.h"

namespace todbench {

/// Measures as measure() does, and writes trials and presentations one by one. A disk error stops the run with `io`;
/// the result then contains only the trials on the disk. `kept`: binary keeps only the answers to the first frame of
/// each presentation. Presentations of a simulated scene have no host time, in the result and on the disk.
[[nodiscard]] Result<MeasurementResult> record_trials(const OpenSession& open, OpenedBench& bench, Observer& observer,
                                                      TrialSchedule& schedule, const MeasurementOptions& options,
                                                      SessionCurve which, AnswerKind kept, std::stop_token stop);

/// Writes the first thousand lines of the modules' standard error to the log of the session.
[[nodiscard]] ModuleLine module_log(SessionFolder& folder);

/// Passes the frames of a bench through the modules, then through the added stages.
void put_behind(OpenedBench& bench, const std::vector<ModulePlan>& modules, const AddedStages& added,
                const ModuleLine& log_line, MeasurementOptions& options);

}  // namespace todbench
