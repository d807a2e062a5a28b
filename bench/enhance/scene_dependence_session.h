// Scene dependence as a session: a folder without a curve, whose numbers are measures and whose limit is the tolerance.
#pragma once

#include <optional>
#include <stop_token>
#include <string>

#include "bench/enhance/scene_dependence.h"
#include "bench/run/experiment.h"

namespace todbench {

/// What was asked for.
struct SceneDependenceTask {
  std::optional<EnhancementPackage> package{};  ///< behind the simulated sensor; the session keeps it
  double bar_k = 40;                            ///< of the simulated bar
  SceneDependenceOptions options{};
};

struct SceneDependenceSession {
  SceneDependence found;
  std::filesystem::path folder;
  Verdict verdict;
  std::optional<Error> ended_by;  ///< what the disk refused
};

/// scene-dependence.json of a session, and what the command says.
[[nodiscard]] Json scene_dependence_json(const SceneDependence& found, const SceneDependenceTask& task);

/// The tolerance as the one demand: by 95 % intervals of all sizes together, of the size that is farthest off. The
/// limits of the plan are about a curve; the reason says that they are not judged.
[[nodiscard]] Verdict verdict_on(const SceneDependence& found, const LimitsPlan& limits);

/// plan_scene_dependence() into a session folder: scene-dependence.json, measures.json with the ratios and both
/// pictures, verdict, report. Errors: those of plan_scene_dependence(), without a folder until the first frame is
/// asked for, with one marked interrupted after that.
[[nodiscard]] Result<SceneDependenceSession> measure_scene_dependence_session(const LoadedPlan& loaded,
                                                                              const SceneDependenceTask& task,
                                                                              const ExperimentOptions& options,
                                                                              const ExperimentListener& listener,
                                                                              std::stop_token stop);

}  // namespace todbench
