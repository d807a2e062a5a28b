// SPDX-License-Identifier: GPL-3.0-or-later
// From a plan to a session folder: measures, simulates the twin, compares, judges, reports.
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

#include "bench/devices/devices.h"
#include "bench/devices/experiment_host.h"
#include "bench/judgement/verdict.h"
#include "bench/plan/loaded_plan.h"
#include "bench/plan/plan_options.h"
#include "bench/session/display_record.h"
#include "bench/session/json_output.h"
#include "bench/session/provenance.h"
#include "bench/session/session_folder.h"
#include "bench/twin/experiment_inputs.h"
#include "tod/camera_measures/camera_measures.h"

namespace todbench {

/// Progress callbacks for a terminal or a window; they do not affect the run. Called from the thread of the run.
struct ExperimentListener {
  std::function<void(std::string_view phase)> on_phase{};
  std::function<void(std::size_t done, std::size_t planned)> on_progress{};
  std::function<void(std::string_view sentence)> on_note{};
  /// Called when the camera is lost. The run waits for the camera for at most `patience` (0 in a replay). A note also
  /// reports the loss.
  std::function<void(const SourceInfo& camera, std::chrono::milliseconds patience)> on_lost{};
  /// Called while the run waits for the target, and with an empty value when the wait ends.
  OnTargetWait on_wait{};
  /// Called when the session folder exists and contains the plan.
  std::function<void(const std::filesystem::path& folder)> on_session{};
  std::function<void(const SourceInfo&)> on_open{};
  /// Called for every frame of the camera as it arrives, valid or not. Not called for frames of the twin.
  std::function<void(const Frame&)> on_frame{};
  std::function<void(SessionCurve, const SetUpRecord&)> on_set_up{};
  /// Called when a trial has been written to the disk. The patch is the patch that the observer judged. The references
  /// are valid only during the call.
  std::function<void(SessionCurve, const Trial&, const Patch&)> on_trial{};
};

/// Folder and control of a run.
struct ExperimentOptions {
  std::filesystem::path folder;                      ///< session folder to create
  ExistingFolder existing = ExistingFolder::refuse;  ///< treatment of a folder that is not empty
  ExperimentHost host{};                             ///< controls the run
  std::optional<OriginRecord> origin{};  ///< origin of a run on the recorded frames of an earlier session; empty: none
};

/// Result of a run. The session folder contains the same results.
struct ExperimentOutcome {
  std::filesystem::path folder;
  TodCurve curve;                ///< measured, or simulated by simulate_plan()
  std::optional<TodCurve> twin;  ///< simulated; with a measured curve only
  std::optional<Comparison> comparison;
  Verdict verdict;                                ///< same as verdict.json
  std::optional<CameraMeasures> measures{};       ///< physical measures of the camera, or of a simulation alone
  std::optional<CameraMeasures> twin_measures{};  ///< physical measures of the twin
  SensorPlan effects;                             ///< effects of the simulated sensor
  std::optional<DisplayRecord> at_display{};      ///< thresholds at the operator's display; at_display()
  RunFigures figures;                             ///< figures of the run that produced `curve`
  double twin_s = 0;                              ///< duration of the simulation of `twin`
  std::optional<TimeForecast> forecast{};         ///< made before the first presentation; as Provenance::forecast
  std::optional<Error> ended_by;              ///< reason for an early stop; the folder is valid and marked interrupted
  std::vector<Presentation> presentations{};  ///< presentations of `curve`
  std::optional<CurveUncertainty> uncertainty{};  ///< uncertainty of `curve`; empty if the plan has no budget
};

/// Measures with the devices of the plan, simulates the twin of the camera, and compares camera and twin. Returns an
/// error if nothing could be measured. If the reason is that a device cannot be opened, there is no session folder.
/// After any other error the session folder exists and is marked interrupted. The files that the plan names are not
/// read again, because `loaded` contains them.
[[nodiscard]] Result<ExperimentOutcome> measure_plan(const LoadedPlan& loaded, const ExperimentOptions& options,
                                                     const ExperimentListener& listener, std::stop_token stop);
/// Loads the plan (LoadedPlan::load()) and measures with the overload above.
[[nodiscard]] Result<ExperimentOutcome> measure_plan(const Plan& plan, const ExperimentOptions& options,
                                                     const ExperimentListener& listener, std::stop_token stop);

/// Measures as measure_plan(), with devices that are already open.
[[nodiscard]] Result<ExperimentOutcome> measure_on_bench(const LoadedPlan& loaded, const ExperimentInputs& inputs,
                                                         OpenedBench bench, const ExperimentOptions& options,
                                                         const ExperimentListener& listener, std::stop_token stop);

/// Measures as measure_plan(), but with the simulated sensor in place of the camera, and adds its direct estimate.
[[nodiscard]] Result<ExperimentOutcome> simulate_plan(const LoadedPlan& loaded, const ExperimentOptions& options,
                                                      const ExperimentListener& listener, std::stop_token stop);
/// Loads the plan (LoadedPlan::load()) and simulates with the overload above.
[[nodiscard]] Result<ExperimentOutcome> simulate_plan(const Plan& plan, const ExperimentOptions& options,
                                                      const ExperimentListener& listener, std::stop_token stop);

}  // namespace todbench
