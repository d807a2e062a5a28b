// From a plan to a session folder: measure, simulate the twin, compare, judge, report.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "bench/judgement/verdict.h"
#include "bench/plan/loaded_plan.h"
#include "bench/plan/plan_options.h"
#include "bench/run/devices.h"
#include "bench/run/experiment_host.h"
#include "bench/run/experiment_inputs.h"
#include "bench/session/json_output.h"
#include "bench/session/session_folder.h"
#include "tod/camera_measures/camera_measures.h"

namespace todbench {

/// What goes on, for a terminal or a window; it decides nothing. Called from the thread of the run.
struct ExperimentListener {
  std::function<void(std::string_view phase)> on_phase{};
  std::function<void(std::size_t done, std::size_t planned)> on_progress{};
  std::function<void(std::string_view sentence)> on_note{};
  /// The camera was lost and is waited for, `patience` at most; also said as a note. A replay waits for nothing: 0.
  std::function<void(const SourceInfo& camera, std::chrono::milliseconds patience)> on_lost{};
  /// The target takes its time, or does no longer (nothing).
  OnTargetWait on_wait{};
  /// The folder exists and holds the plan.
  std::function<void(const std::filesystem::path& folder)> on_session{};
  std::function<void(const SourceInfo&)> on_open{};
  /// Every frame of the camera as it arrives, good or bad; not those of the twin.
  std::function<void(const Frame&)> on_frame{};
  std::function<void(SessionCurve, const SetUpRecord&)> on_set_up{};
  /// A trial that is on disk, and the patch that was judged, lent for the call.
  std::function<void(SessionCurve, const Trial&, const Patch&)> on_trial{};
};

struct ExperimentOptions {
  std::filesystem::path folder;
  ExistingFolder existing = ExistingFolder::refuse;
  ExperimentHost host{};  ///< who commands the run
};

/// What a run came to. The session folder holds the same.
struct ExperimentOutcome {
  std::filesystem::path folder;
  TodCurve curve;                ///< measured, or simulated for simulate_plan()
  std::optional<TodCurve> twin;  ///< simulated, beside a measured curve
  std::optional<Comparison> comparison;
  Verdict verdict;                                ///< as verdict.json
  std::optional<CameraMeasures> measures{};       ///< physical, of the camera or of the simulated sensor alone
  std::optional<CameraMeasures> twin_measures{};  ///< of the twin
  SensorPlan effects;                             ///< of the simulated sensor
  RunFigures figures;                             ///< of `curve`
  std::optional<Error> ended_by;                  ///< why it stopped early; the folder is valid and marked interrupted
  std::vector<Presentation> presentations{};      ///< of `curve`
  std::optional<CurveUncertainty> uncertainty{};  ///< of `curve`; nothing where the plan has no budget
};

/// Measures with the devices of the plan, runs its simulated twin and compares. Fails when nothing could be measured:
/// without a folder when a device cannot be opened, with a folder marked interrupted after that. Of what the plan names
/// nothing is read again.
[[nodiscard]] Result<ExperimentOutcome> measure_plan(const LoadedPlan& loaded, const ExperimentOptions& options,
                                                     const ExperimentListener& listener, std::stop_token stop);
/// The same after LoadedPlan::load().
[[nodiscard]] Result<ExperimentOutcome> measure_plan(const Plan& plan, const ExperimentOptions& options,
                                                     const ExperimentListener& listener, std::stop_token stop);

/// measure_plan() on a bench that is open already.
[[nodiscard]] Result<ExperimentOutcome> measure_on_bench(const LoadedPlan& loaded, const ExperimentInputs& inputs,
                                                         OpenedBench bench, const ExperimentOptions& options,
                                                         const ExperimentListener& listener, std::stop_token stop);

/// The same with the simulated sensor in place of the camera, and its direct estimate.
[[nodiscard]] Result<ExperimentOutcome> simulate_plan(const LoadedPlan& loaded, const ExperimentOptions& options,
                                                      const ExperimentListener& listener, std::stop_token stop);
[[nodiscard]] Result<ExperimentOutcome> simulate_plan(const Plan& plan, const ExperimentOptions& options,
                                                      const ExperimentListener& listener, std::stop_token stop);

}  // namespace todbench
