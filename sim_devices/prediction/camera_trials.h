// A model observer before an emulated camera: single pictures, and pictures from dynamic super-resolution of many.
#pragma once

#include <stop_token>
#include <vector>

#include "acquisition/core/accuracy.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/sensor/sensor_spec.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Where the frames of a super-resolved picture lie against each other.
enum class FrameDisplacements {
  anywhere,      ///< evenly over half a pitch each way, as a hand or a platform moves: samples are off the fine grid
  half_pitches,  ///< exact multiples of half a pitch: every sample lies on the fine grid
};

struct CameraTrialOptions {
  double delta_t_k = 0;             ///< of every triangle, not 0
  std::vector<double> sizes_pitch;  ///< each is shown four times in a picture, once in each orientation
  int presentations = 24;           ///< pictures, each in a sampling phase of its own; at least 2
  int frames = 16;                  ///< per super-resolved picture, displaced against each other by up to half a pitch
  FrameDisplacements displacements = FrameDisplacements::anywhere;
  int graded_draws = 32;  ///< of the observer's own noise, for the probabilities of one picture
  Accuracy accuracy;
  std::uint64_t seed = 1;
  std::stop_token stop{};
};

/// Answers to one kind of pictures. Sizes in mrad.
struct PictureAnswers {
  std::vector<Level> levels;         ///< right and wrong; the cluster of a level is its presentation
  std::vector<GradedAnswer> graded;  ///< the same ones, as probable as the observer finds them; one set-up
};

/// Answers of one observer.
struct CameraTrials {
  PictureAnswers still;           ///< first frame of each presentation
  PictureAnswers super_resolved;  ///< all its frames, registered and averaged on a grid of half the pitch
};

/// What the observers (one entry each) and the registration did.
struct CameraTrialRecord {
  std::vector<CameraTrials> observers;
  double frames_registered = 0;    ///< per super-resolved picture; the others could not be registered
  double registration_rms_px = 0;  ///< found minus true displacement, per axis
  double frames_per_sample = 0;    ///< averaged in a sample of the super-resolved picture
  double placement_rms_px = 0;     ///< of averaged samples against the grid, per axis
};

/// Frames are those of the simulated camera, counts and all: byte for byte what it sends over its emulated link. All
/// observers judge the same pictures. `invalid_input` for options that cannot be met, `interrupted`.
[[nodiscard]] Result<CameraTrialRecord> camera_trials(const SensorSpec& sensor,
                                                      const std::vector<TemplateObserver*>& observers,
                                                      const CameraTrialOptions& options);

}  // namespace todbench
