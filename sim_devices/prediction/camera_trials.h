// SPDX-License-Identifier: GPL-3.0-or-later
// Trials of a model observer with an emulated camera: single pictures, and super-resolved pictures of many frames.
#pragma once

#include <stop_token>
#include <vector>

#include "acquisition/base/accuracy.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/sensor/sensor_spec.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Displacements between the frames of a super-resolved picture.
enum class FrameDisplacements {
  anywhere,  ///< distributed evenly over half a pitch in each direction, as by hand or platform; samples lie off the
             ///< fine grid
  half_pitches,  ///< exact multiples of half a pitch; every sample lies on the fine grid
};

/// Options of the trials.
struct CameraTrialOptions {
  double delta_t_k = 0;             ///< contrast of every triangle; not 0
  std::vector<double> sizes_pitch;  ///< sizes above 0.1 and below 40; each is shown in four orientations per picture
  int presentations = 24;           ///< pictures, each with its own sampling phase; at least 2
  int frames = 16;                  ///< frames of a super-resolved picture, at least 4, displaced by up to half a pitch
  FrameDisplacements displacements = FrameDisplacements::anywhere;
  int graded_draws = 32;  ///< draws of the observer's internal noise for the probabilities of one picture
  Accuracy accuracy;
  std::uint64_t seed = 1;
  std::stop_token stop{};
};

/// Answers to one kind of picture. Sizes in mrad.
struct PictureAnswers {
  std::vector<Level> levels;         ///< correct and wrong answers; the cluster of a level is its presentation
  std::vector<GradedAnswer> graded;  ///< graded answers to the same triangles; one set-up
};

/// Answers of one observer.
struct CameraTrials {
  PictureAnswers still;           ///< first frame of each presentation
  PictureAnswers super_resolved;  ///< all frames, registered and averaged on a grid of half the pitch
};

/// Answers of the observers (one entry each) and statistics of the registration.
struct CameraTrialRecord {
  std::vector<CameraTrials> observers;
  double frames_registered = 0;    ///< mean number of registered frames of a super-resolved picture
  double registration_rms_px = 0;  ///< rms of estimated minus true displacement, per axis
  double frames_per_sample = 0;    ///< mean number of frames averaged in a sample of the super-resolved picture
  double placement_rms_px = 0;     ///< rms distance of averaged samples from the fine grid, per axis
};

/// Runs the trials. Frames are byte for byte the counts that the simulated camera sends over its emulated link. All
/// observers judge the same pictures. Errors: `invalid_input` (options that cannot be met), `interrupted`.
[[nodiscard]] Result<CameraTrialRecord> camera_trials(const SensorSpec& sensor,
                                                      const std::vector<TemplateObserver*>& observers,
                                                      const CameraTrialOptions& options);

}  // namespace todbench
