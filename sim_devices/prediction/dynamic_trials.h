// SPDX-License-Identifier: GPL-3.0-or-later
// Trials of a model observer with a simulated camera whose target moves at constant speed: passes of several frames.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <stop_token>
#include <vector>

#include "acquisition/base/accuracy.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/module/picture_stage.h"
#include "sim_devices/sensor/sensor_spec.h"
#include "tod/measurement/sequence_judge.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Options of the trials.
struct DynamicTrialOptions {
  double delta_t_k = 0;               ///< contrast of every triangle; not 0
  std::vector<double> sizes_pitch;    ///< sizes above 0.1 and below 40; each is shown in four orientations per picture
  std::vector<double> speeds_mrad_s;  ///< along x, at least 0, at most 5 pixels per frame; alternating right and left
  int passes = 24;                    ///< each with its own sampling phase; at least 2
  int frames = 8;                     ///< frames of a pass, at least 1
  Accuracy accuracy;
  std::uint64_t seed = 1;
  /// Stages after the camera, created for every pass; empty: none. Before the first frame of a pass, the stages receive
  /// as many frames of the same motion as they store. The lag of the stages is not removed. Contrast and noise are
  /// measured after the stages, with the plate at rest.
  std::function<std::vector<std::unique_ptr<ChainStage>>()> stages{};
  std::stop_token stop{};
};

/// Answers at one speed. Sizes in mrad. The cluster of a level is its pass.
struct DynamicTrials {
  double speed_mrad_s = 0, speed_px = 0;                                 ///< speed_px: in pixels per frame
  std::array<std::vector<Level>, all_sequence_observers.size()> levels;  ///< by SequenceObserver
};

/// Runs the trials. Frames are the counts of the simulated camera. Frame k of a pass has the same random numbers at
/// every speed, and each pass starts in the same sampling phase, so ratios between speeds are paired. The picture has
/// no lag, because the transfer functions of time constant and exposure have their mean lag removed. A triangle is
/// judged at its position at the time at which its rows are read. Internal noise is drawn once per decision, for any
/// number of frames. Errors: `invalid_input` (options; a sensor with modules, microscan, super-resolution or non-square
/// pixels; clipped frames), `not_identifiable` (no contrast after the stages), `interrupted`, errors of the stages.
[[nodiscard]] Result<std::vector<DynamicTrials>> dynamic_trials(const SensorSpec& sensor, TemplateObserver& observer,
                                                                const DynamicTrialOptions& options);

}  // namespace todbench
