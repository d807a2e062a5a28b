// A model observer before a simulated camera whose target moves at constant speed: passes of several frames.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <stop_token>
#include <vector>

#include "acquisition/core/accuracy.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/module/picture_stage.h"
#include "sim_devices/sensor/sensor_spec.h"
#include "tod/measurement/sequence_judge.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

struct DynamicTrialOptions {
  double delta_t_k = 0;               ///< of every triangle, not 0
  std::vector<double> sizes_pitch;    ///< each is shown four times in a picture, once in each orientation
  std::vector<double> speeds_mrad_s;  ///< along x, 0 or more; passes to the right and to the left in turn
  int passes = 24;                    ///< each in a sampling phase of its own; at least 2
  int frames = 8;                     ///< of a pass, at least 1
  Accuracy accuracy;
  std::uint64_t seed = 1;
  /// Made anew for every pass, behind the camera; empty: none. Before the first frame of a pass they see as many
  /// frames of the same motion as they remember. Their lag is not taken out.
  std::function<std::vector<std::unique_ptr<ChainStage>>()> stages{};
  std::stop_token stop{};
};

/// Answers at one speed. Sizes in mrad; the cluster of a level is its pass.
struct DynamicTrials {
  double speed_mrad_s = 0, speed_px = 0;                                 ///< pixels per frame
  std::array<std::vector<Level>, all_sequence_observers.size()> levels;  ///< by SequenceObserver
};

/// Frames are those of the simulated camera, counts and all. Frame k of a pass has the same random numbers at every
/// speed, and every pass the same sampling phase in its first frame: ratios between speeds are paired. The picture lags
/// by nothing: the transfers of time constant and exposure have their mean lag taken out, and a triangle
/// is judged where the rows that see it are when they are read. Internal noise is drawn once for each
/// decision, whatever the number of frames. `invalid_input` for options that cannot be met, a sensor with modules,
/// microscan or super-resolution; `interrupted`; errors of the stages.
[[nodiscard]] Result<std::vector<DynamicTrials>> dynamic_trials(const SensorSpec& sensor, TemplateObserver& observer,
                                                                const DynamicTrialOptions& options);

}  // namespace todbench
