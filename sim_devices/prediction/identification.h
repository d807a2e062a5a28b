// SPDX-License-Identifier: GPL-3.0-or-later
// Identification experiment: an observer discriminates the targets of a set in the pictures of a simulated camera.
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

/// Range with the transmittance of the air along this range.
struct IdentificationRange {
  double range_m = 100;      ///< distance from camera to target
  double transmittance = 1;  ///< transmittance of the air in the band, 0 to 1
};

/// Pictures of the targets that the observer uses as templates.
enum class TemplateKnowledge {
  behind_camera,          ///< pictures taken by this camera with this motion, as for people who learned from them
  behind_camera_at_rest,  ///< pictures taken by this camera without motion
  ideal                   ///< ideal pictures without blur; a blurred target can then resemble a wrong target
};
/// Differences between the targets.
enum class TargetCues {
  all,   ///< shape, size and temperature pattern
  shape  ///< every view has a uniform contrast, its dT_RSS, and is scaled to the mean size of the set
};

/// Uses of the frames of a pass that identify() supports.
inline constexpr std::array identification_sequences{SequenceObserver::single_frame, SequenceObserver::tracking_sum,
                                                     SequenceObserver::static_sum};

/// Experiment to simulate.
struct IdentificationTask {
  SensorSpec sensor;
  SensorPlan plan;  ///< planned effects
  TemplateObserverSpec observer{};
  Accuracy accuracy{};
  std::vector<IdentificationTarget> targets;                       ///< targets that the observer discriminates
  std::vector<IdentificationRange> ranges;                         ///< ranges with their air
  TemplateKnowledge knowledge = TemplateKnowledge::behind_camera;  ///< pictures that the observer uses as templates
  TargetCues cues = TargetCues::all;                               ///< differences between the targets
  int decisions = 2000;                                            ///< decisions per target and range, over all aspects
  /// Motion of the targets in the picture, because the targets move or the camera turns. The plan must include the
  /// effects of this motion.
  SceneMotion motion{};
  /// Use of the frames of a pass, as for a moving triangle; internal noise is drawn once per decision.
  SequenceObserver sequence = SequenceObserver::single_frame;  ///< one of `identification_sequences`
  int frames = 8;                                              ///< frames of a pass; not used for a single frame
  /// Stages after the camera, created for every pass if they have a memory; empty: none. Before the first frame of a
  /// pass, the stages receive as many frames of the same motion as they store. The lag of the stages is not removed.
  std::function<std::vector<std::unique_ptr<ChainStage>>()> stages{};
  /// Largest distance, in samples, over which a picture influences a sample after the stages; empty: the whole picture
  /// has an influence.
  std::optional<int> stage_reach_px{};
  /// Cn2 of the turbulence along the path of each range, instead of the sensor's Cn2; 0: as in the sensor. The plan
  /// must simulate turbulence. The templates of an observer whose knowledge includes the camera include this air.
  double cn2_m_minus_2_3 = 0;
  std::uint64_t seed = 1;
  std::stop_token stop{};
};

/// Returns the sensor of the task at a range, as planned.
[[nodiscard]] SensorSpec sensor_at(const IdentificationTask& task, double range_m);

/// Contrast and noise of the pictures after the stages, measured in pictures at rest.
struct JudgedPictures {
  double gain = 1;  ///< contrast after the stages over contrast before, all views together; divides the pictures
  double least_gain = 1, largest_gain = 1;  ///< smallest and largest gain of a single view
  double noise_k = 0;                       ///< temporal noise of a sample divided by the gain: mean over the views
};

/// Result at one range.
struct IdentificationPoint {
  double range_m = 0, transmittance = 1;
  std::vector<std::vector<int>> answers;  ///< number of answers, [shown target][answered target]
  /// Share of correct answers for each draw of noise. Draws are independent. All targets and aspects use the same
  /// draws.
  std::vector<double> by_draw;
  /// Lowest and highest proportion correct of an observer with an eye, over the limits of its open parameters.
  std::optional<std::pair<double, double>> spread{};
  std::optional<JudgedPictures> judged{};  ///< contrast and noise after the stages; empty without stages
  [[nodiscard]] double proportion() const;
  [[nodiscard]] double standard_error() const;
};

/// Predicted effort of an experiment.
struct IdentificationEffort {
  double decisions = 0;      ///< number for all targets and ranges
  double largest_bytes = 0;  ///< memory of the templates of one range
  double processor_s = 0;    ///< time on one core that projects 2 x 10^10 template samples a second, within a factor of
                             ///< two
};
/// Predicts the effort without running the experiment. Errors: those of identify() about the targets and their size.
[[nodiscard]] Result<IdentificationEffort> planned_effort(const IdentificationTask& task);

/// Returns one point per range, in the same order. Every target in every aspect is shown with each draw of sensor noise
/// and internal noise. The sampling phase is one of 16 and changes from draw to draw. The observer specification sets
/// the internal noise and the factor by which sensor noise is enlarged. The contrast is dT_RSS attenuated by the air;
/// an observer with an eye judges the luminance contrast of its display. As in dynamic_trials(), a target in motion is
/// judged at its true position, without the mean lag of time constant and exposure. Each row is judged at the time at
/// which it is read.
///
/// Stages receive rounded and clipped counts of the window and its surround, or of the whole picture if a stage needs
/// the whole picture. Internal noise is relative to the contrast of a view in the judged pictures, and the enlarged
/// sensor noise is the noise of the judged pictures. A gain of the stages therefore has no effect. The templates do not
/// include the stages. Ranges run in parallel on all processors, and the result does not depend on their number. Dead
/// detectors are left out. Rounding is applied to the noise, not to the signal. Errors: `invalid_input` (fewer than two
/// targets, targets that are equal from every side, a target without contrast, counts too coarse for the noise, targets
/// too large for the observer, more than 5 pixels per frame, motion with microscan or super-resolution, several frames
/// with image dance, targets that do not fit into the picture of a stage, contrasts that reach the lowest or highest
/// count), `not_identifiable` (no contrast after the stages), `interrupted`, errors of the stages.
[[nodiscard]] Result<std::vector<IdentificationPoint>> identify(const IdentificationTask& task);

/// Pictures of identify() for use with a different observer. Immutable, thread-safe.
class IdentificationFrames {
 public:
  /// Prepares the pictures of a task. Errors: those of identify() about the targets.
  [[nodiscard]] static Result<IdentificationFrames> of(const IdentificationTask& task);
  /// Returns kelvin above the background as displayed, with the noise of draw `draw` and the sampling phase that
  /// identify() uses for this view and draw. All frames of a range have the same size. Errors: those of the stages.
  [[nodiscard]] Result<cv::Mat1f> frame_k(std::size_t range, std::size_t target, std::size_t aspect,
                                          std::uint64_t draw) const;
  /// Returns the contrast dT_RSS of a view in kelvin, attenuated by the air.
  [[nodiscard]] double contrast_k(std::size_t range, std::size_t target, std::size_t aspect) const;

 private:
  struct Range;
  IdentificationFrames() = default;
  std::vector<std::shared_ptr<const Range>> ranges_;
  std::vector<std::vector<double>> contrasts_k_;  ///< [target][aspect], before attenuation by the air
};

}  // namespace todbench
