// SPDX-License-Identifier: GPL-3.0-or-later
// The trials of a camera, its curve before the fit, and its physical measures.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "acquisition/recording/frame_stream.h"
#include "bench/devices/camera_settings.h"
#include "bench/devices/devices.h"
#include "bench/devices/experiment_host.h"
#include "bench/run/session_end.h"
#include "bench/twin/camera_surrogate.h"
#include "bench/twin/experiment_inputs.h"
#include "tod/camera_measures/camera_measures.h"
#include "tod/measurement/measurement.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Trials of the camera.
struct MeasuredRun {
  MeasurementResult result;
  MeasurementOptions options;
  std::map<double, ProportionTable> functions{};  ///< functions for the stopping rule of an adaptive schedule
  std::vector<ChangedSetting> changed{};          ///< settings that changed between opening and last frame
  double measures_s = 0;                          ///< duration of the physical measures; 0: no measures
};

/// Returns the response of the contrast estimator for each plate, computed with the twin of the plan.
[[nodiscard]] Result<std::map<std::string, double>> responses_of_camera(const Plan& plan,
                                                                        const ExperimentInputs& inputs,
                                                                        std::stop_token stop);

/// Measures with the camera of the plan and writes to the session. `surrogate` is estimated from the frames of the
/// camera.
[[nodiscard]] Result<MeasuredRun> run_measured(const Plan& plan, const ExperimentInputs& inputs,
                                               CameraSurrogate& surrogate, OpenedBench& bench, const OpenSession& open,
                                               const AddedStages& added, std::stop_token stop);

/// Returns the curve of these trials without the shape of the twin. Fails if no curve can be fitted to the trials.
[[nodiscard]] Result<TodCurve> curve_of_camera(MeasurementResult& result, std::span<const Trial> trials,
                                               const Plan& plan, const ExperimentInputs& inputs, const SourceInfo& info,
                                               const OpenSession& open);

/// Measures the physical measures of the camera and stores their duration. Then checks that the recording is complete
/// on disk. `recording`: null if there is no recording. An error ends the run.
[[nodiscard]] std::optional<CameraMeasures> measures_of_camera(MeasuredRun& measured, const Plan& plan,
                                                               const ExperimentInputs& inputs, OpenedBench& bench,
                                                               FrameStreamWriter* recording, const OpenSession& open,
                                                               std::stop_token stop);

/// Waits until the camera meets the condition of [camera.warm_up], and returns a sentence about the wait. Tolerates the
/// rejection of up to half of the frames, because a camera often corrects itself while it warms up.
[[nodiscard]] Result<std::string> warmed_up(FrameSource& camera, const Plan& plan, const std::stop_token& stop);

}  // namespace todbench
