// SPDX-License-Identifier: GPL-3.0-or-later
// Identification experiment: an observer distinguishes the targets of a set behind a simulated camera.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/base/accuracy.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/module/picture_stage.h"
#include "sim_devices/scene/field_scene.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"
#include "tod/measurement/sequence_judge.h"

namespace todbench {

struct IdentificationRange {
  double range_m = 100;
  double transmittance = 1;
};

/// The observer's knowledge of its targets.
enum class TemplateKnowledge {
  behind_camera,          ///< pictures behind this camera in this motion, as people have who learned from them
  behind_camera_at_rest,  ///< pictures behind this camera without motion
  ideal                   ///< ideal pictures only: blur then makes targets look like others
};
/// Differences between the targets.
enum class TargetCues {
  all,   ///< shape, size and temperature pattern
  shape  ///< every view has its dT_RSS uniformly, and the mean size of the set
};

/// Uses of the frames of a pass that identify() has.
inline constexpr std::array identification_sequences{SequenceObserver::single_frame, SequenceObserver::tracking_sum,
                                                     SequenceObserver::static_sum};

struct IdentificationTask {
  SensorSpec sensor;
  SensorPlan plan;  ///< of effects
  TemplateObserverSpec observer{};
  Accuracy accuracy{};
  std::vector<IdentificationTarget> targets;
  std::vector<IdentificationRange> ranges;
  TemplateKnowledge knowledge = TemplateKnowledge::behind_camera;
  TargetCues cues = TargetCues::all;
  int decisions = 2000;  ///< per target and range, all aspects together
  /// Of the targets in the picture: they move, or the camera turns. The plan must be made for it.
  SceneMotion motion{};
  /// Use of the frames of a pass, as for a moving triangle; internal noise is drawn once per decision.
  SequenceObserver sequence = SequenceObserver::single_frame;  ///< one of `identification_sequences`
  int frames = 8;                                              ///< of a pass; a single frame ignores them
  /// Stages behind the camera, made anew for every pass if they have a memory; empty: none. Before the first frame of a
  /// pass they receive as many frames of the same motion as they remember. Their lag is not removed.
  std::function<std::vector<std::unique_ptr<ChainStage>>()> stages{};
  /// Largest distance, in samples, over which a picture influences a sample behind the stages; empty: the whole picture
  /// does.
  std::optional<int> stage_reach_px{};
  /// Turbulence along the path of each range, instead of that of the sensor; 0: as in the sensor. The plan must
  /// simulate it. An observer with knowledge behind the camera also knows the targets behind this air.
  double cn2_m_minus_2_3 = 0;
  std::uint64_t seed = 1;
  std::stop_token stop{};
};

/// Sensor of the task at a range, as planned.
[[nodiscard]] SensorSpec sensor_at(const IdentificationTask& task, double range_m);

/// Contrast and noise of the pictures behind the stages, measured in pictures at rest.
struct JudgedPictures {
  double gain = 1;  ///< of the contrast of all views together; judged pictures are divided by it
  double least_gain = 1, largest_gain = 1;  ///< of single views
  double noise_k = 0;                       ///< temporal noise of a sample, divided by the gain: mean over the views
};

struct IdentificationPoint {
  double range_m = 0, transmittance = 1;
  std::vector<std::vector<int>> answers;  ///< [shown][answered]
  /// Share of correct answers for each draw of noise. Draws are independent; targets and aspects share them.
  std::vector<double> by_draw;
  /// Proportion correct of an observer with an eye at the worst and the best end of the range of its open parameters.
  std::optional<std::pair<double, double>> spread{};
  std::optional<JudgedPictures> judged{};  ///< with stages
  [[nodiscard]] double proportion() const;
  [[nodiscard]] double standard_error() const;
};

/// Predicted effort of an experiment.
struct IdentificationEffort {
  double decisions = 0;      ///< all targets and ranges
  double largest_bytes = 0;  ///< memory of the templates of one range
  double processor_s = 0;    ///< on one core with about 2 x 10^10 template samples a second, to a factor of two
};
/// Predicts the effort without computing. Errors: those of identify() about the targets.
[[nodiscard]] Result<IdentificationEffort> planned_effort(const IdentificationTask& task);

/// One point per range, in the same order. Every target in every aspect meets each draw of sensor and internal noise,
/// in one of 16 sampling phases that the draws take in turn. Internal noise and the enlargement of the sensor's noise
/// are those of the template observer; the contrast is dT_RSS behind the air, and an observer with an eye sees it at
/// the luminance contrast of its display. A target in motion is judged at its true place, without the mean lag of time
/// constant and exposure, and each row at its time, as in dynamic_trials().
///
/// Stages receive rounded and clipped counts: of the window and its surround, or of the whole picture if a stage needs
/// it. The contrast of a view, to which internal noise is relative, and the noise that the observer enlarges are those
/// of the judged pictures; so a gain changes nothing. The observer knows its targets without the stages. Ranges run in
/// parallel on all processors, and the result does not depend on their number. Dead detectors are left out. Counts are
/// rounded with the noise, not with the signal. Errors: `invalid_input` (fewer than two targets, targets that look
/// alike from every side, a target without contrast, counts too coarse for the noise, targets too large for the
/// observer, more than 5 pixels per frame, motion in front of microscan or super-resolution, several frames with image
/// dance, targets that do not fit into the picture of a stage, contrasts that reach an end of the counts),
/// `not_identifiable` (no contrast behind the stages), `interrupted`, errors of the stages.
[[nodiscard]] Result<std::vector<IdentificationPoint>> identify(const IdentificationTask& task);

/// Pictures of identify() for another observer. Immutable, thread-safe.
class IdentificationFrames {
 public:
  /// Errors: those of identify() about the targets.
  [[nodiscard]] static Result<IdentificationFrames> of(const IdentificationTask& task);
  /// Displayed kelvin above the background, with the noise of this draw and its sampling phase for this view, as in
  /// identify() of the same task. All frames of a range have one size. Errors: those of the stages.
  [[nodiscard]] Result<cv::Mat1f> frame_k(std::size_t range, std::size_t target, std::size_t aspect,
                                          std::uint64_t draw) const;
  /// Contrast dT_RSS behind the air.
  [[nodiscard]] double contrast_k(std::size_t range, std::size_t target, std::size_t aspect) const;

 private:
  struct Range;
  IdentificationFrames() = default;
  std::vector<std::shared_ptr<const Range>> ranges_;
  std::vector<std::vector<double>> contrasts_k_;  ///< [target][aspect], in front of the air
};

}  // namespace todbench
