// SPDX-License-Identifier: GPL-3.0-or-later
// Picture of a scene after every stage of air, camera and eye.
#pragma once

#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/base/accuracy.h"
#include "bench/plan/atmospheres.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/atmosphere/turbulence.h"
#include "sim_devices/module/picture_stage.h"
#include "sim_devices/prediction/effect_planner.h"
#include "sim_devices/scene/field_scene.h"
#include "sim_devices/sensor/scene_signal.h"

namespace todbench {

/// Scene and camera.
struct ScenePicturesTask {
  FieldScene scene;
  SensorSpec sensor;
  TemplateObserverSpec observer{};
  Atmosphere air{};
  SceneView view{};      ///< range and position of the scene
  SceneMotion motion{};  ///< motion of the picture across the detectors: the target moves, or the camera turns
  Accuracy accuracy{};
  /// Stages after the camera. The stages receive as many frames of the same motion as their memory stores. Empty: none.
  std::function<std::vector<std::unique_ptr<ChainStage>>()> stages{};
  EffectPlannerOptions effects{};  ///< options of the effect planner
  std::uint64_t seed = 1;
  int field_pitch = 0;  ///< side of the displayed square, in pitches; 0: the target with a margin
};

/// One stage. All stages of a task show the same field.
struct SceneStage {
  std::string name;         ///< name of the files of this stage: "1-scene"
  std::string title, note;  ///< title and remark for people
  cv::Mat1f kelvin;         ///< equivalent kelvin above the background
  double pixels_per_pitch = 1;
};

/// Decision of the planner about one part of scene and air, with its reason.
struct AirDecision {
  std::string name;
  Decision decision = Decision::simulate;
  std::string reason;
};

/// Returns whether an effect belongs to the air. The decision about such an effect is listed with the decisions about
/// the air.
[[nodiscard]] constexpr bool is_of_air(Effect effect) {
  return effect == Effect::turbulence || effect == Effect::image_dance;
}

/// Effect of the turbulence on this camera.
struct TurbulenceSeen {
  TurbulentPath path{};
  double r0_m = 0;            ///< coherence diameter, spherical wave (Fried 1966)
  double mtf_at_nyquist = 1;  ///< long exposure, at the Nyquist frequency of the samples
  /// Standard deviation of the image motion between short exposures, per axis. The long exposure includes this motion.
  double tilt_sd_mrad = 0, tilt_sd_pitch = 0;
};

/// Pictures and numbers of all stages.
struct ScenePictures {
  /// Pictures at the sensor, after the optics, on the detectors, sampled, with noise, on the display, after the stages
  /// (if any), and after the filter of the observer.
  std::vector<SceneStage> stages;
  cv::Mat1f frame;                         ///< whole frame of the camera as displayed, after the stages
  std::optional<double> judged_gain;       ///< gain of the stages; the picture after the stages is divided by the gain
  double grey_low_k = 0, grey_high_k = 1;  ///< black and white of every picture, above the background
  double background_k = 300;               ///< camera reading of the background: scene, air and one conversion
  double transmittance = 1;
  std::optional<TargetSignature> signature;  ///< signature before the air
  double apparent_dt_k = 0;                  ///< contrast attenuated by the air, the input of the effect planner
  EffectPlan effects;
  std::vector<AirDecision> air;
  std::optional<TurbulenceSeen> turbulence;  ///< empty if there is no turbulence
};

/// Renders the stages. Pictures 1 to 3 are finer than the detectors, 4 and 5 have one pixel per sample, and later
/// pictures have eight pixels per sample and axis. Simulates the effects that are needed at the contrast of the target,
/// or all effects if no size has a threshold at this contrast. Errors: `invalid_input` (a range beyond the table of the
/// air), `not_identifiable` (no contrast after the stages), those of scene_signal_k() and of the stages.
[[nodiscard]] Result<ScenePictures> scene_pictures(const ScenePicturesTask& task);

/// Returns a picture of 8 bits, black at low and white at high, enlarged by an integer factor until the longer side has
/// `least_px`.
[[nodiscard]] cv::Mat1b grey_picture(const cv::Mat1f& kelvin, double low_k, double high_k, int least_px);

}  // namespace todbench
