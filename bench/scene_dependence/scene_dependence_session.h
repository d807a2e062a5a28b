// SPDX-License-Identifier: GPL-3.0-or-later
// Session of a scene-dependence test. The session has no curve; its numbers are measures, and its only limit is the
// tolerance.
#pragma once

#include <optional>
#include <stop_token>
#include <string>

#include "bench/run/experiment.h"
#include "bench/scene_dependence/scene_dependence.h"

namespace todbench {

/// Parameters of the test.
struct SceneDependenceTask {
  std::optional<EnhancementPackage> package{};  ///< package applied to the simulated sensor; stored in the session
  double bar_k = 40;                            ///< contrast of the simulated bar
  SceneDependenceOptions options{};
};

/// Result with its session.
struct SceneDependenceSession {
  SceneDependence found;
  std::filesystem::path folder;
  Verdict verdict;
  std::optional<Error> ended_by;  ///< error of the disk
};

/// Returns the content of scene-dependence.json, which is also the output of the command.
[[nodiscard]] Json scene_dependence_json(const SceneDependence& found, const SceneDependenceTask& task);

/// Judges the only demand, the tolerance, at the size with the largest deviation, by simultaneous 95 % intervals.
/// The limits of the plan apply to a curve and are not judged; the reason in the verdict states this.
[[nodiscard]] Verdict verdict_on(const SceneDependence& found, const LimitsPlan& limits);

/// Runs plan_scene_dependence() and writes a session: scene-dependence.json, measures.json with the ratios and both
/// pictures, verdict, report. Errors: those of plan_scene_dependence(). After an error before the first frame there is
/// no folder. After a later error the folder is marked interrupted.
[[nodiscard]] Result<SceneDependenceSession> measure_scene_dependence_session(const LoadedPlan& loaded,
                                                                              const SceneDependenceTask& task,
                                                                              const ExperimentOptions& options,
                                                                              const ExperimentListener& listener,
                                                                              std::stop_token stop);

}  // namespace todbench
