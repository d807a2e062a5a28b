// A scene on its way through air, camera and eye: the picture after every stage.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/core/accuracy.h"
#include "bench/plan/atmospheres.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/atmosphere/turbulence.h"
#include "sim_devices/prediction/effect_planner.h"
#include "sim_devices/scene/field_scene.h"
#include "sim_devices/sensor/scene_signal.h"

namespace todbench {

struct ScenePicturesTask {
  FieldScene scene;
  SensorSpec sensor;
  TemplateObserverSpec observer{};
  Atmosphere air{};
  SceneView view{};
  Accuracy accuracy{};
  EffectPlannerOptions effects{};
  std::uint64_t seed = 1;
  int field_pitch = 0;  ///< side of the square that is shown, in pitches; 0: the target with room round it
};

/// One stage. All of a task show the same field.
struct SceneStage {
  std::string name;         ///< of its files: "1-scene"
  std::string title, note;  ///< for people
  cv::Mat1f kelvin;         ///< above the background, equivalent kelvin
  double pixels_per_pitch = 1;
};

/// What of the scene and its air was simulated, and why.
struct AirDecision {
  std::string name;
  Decision decision = Decision::simulate;
  std::string reason;
};

/// Effects that are the air's: their decisions stand among those of the air.
[[nodiscard]] constexpr bool is_of_air(Effect effect) {
  return effect == Effect::turbulence || effect == Effect::image_dance;
}

/// What turbulence does before this camera.
struct TurbulenceSeen {
  TurbulentPath path{};
  double r0_m = 0;                             ///< Fried's coherence diameter, spherical wave
  double mtf_at_nyquist = 1;                   ///< long exposure, at the Nyquist frequency of the samples
  double tilt_sd_mrad = 0, tilt_sd_pitch = 0;  ///< of the dance of short frames, per axis; part of the long exposure
};

struct ScenePictures {
  std::vector<SceneStage> stages;          ///< at the sensor, optics, detector, sampled, noise, display, observer
  cv::Mat1f frame;                         ///< all of the camera's frame, as displayed
  double grey_low_k = 0, grey_high_k = 1;  ///< black and white of every picture, above the background
  double background_k = 300;               ///< what the camera shows of the background: scene, air and one conversion
  double transmittance = 1;
  std::optional<TargetSignature> signature;  ///< before the air
  double apparent_dt_k = 0;                  ///< contrast behind the air that effects were planned for
  EffectPlan effects;
  std::vector<AirDecision> air;
  std::optional<TurbulenceSeen> turbulence;  ///< nothing where there is none
};

/// Stages 1 to 3 are drawn finer than the detectors, 4 and 5 a pixel a sample, 6 and 7 eight a sample. The effects that
/// matter at the target's contrast are simulated; where no size has a threshold at it, all of them. `invalid_input`:
/// a range beyond the air's table, and whatever scene_signal_k() refuses.
[[nodiscard]] Result<ScenePictures> scene_pictures(const ScenePicturesTask& task);

/// 8 bits, black at low and white at high, larger by a whole factor until its longer side has `least_px`.
[[nodiscard]] cv::Mat1b grey_picture(const cv::Mat1f& kelvin, double low_k, double high_k, int least_px);

}  // namespace todbench
