// An identification experiment: an observer tells targets of a set apart behind a simulated camera.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <stop_token>
#include <string>
#include <vector>

#include "acquisition/core/accuracy.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/scene/field_scene.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// One alternative with its views, each before the same background, the middle of what is seen at the origin.
struct IdentificationTarget {
  std::string name;
  std::vector<FieldScene> aspects;
};

struct IdentificationRange {
  double range_m = 100;
  double transmittance = 1;
};

/// What the observer knows of its targets.
enum class TemplateKnowledge {
  behind_camera,  ///< what they look like behind this camera, as people do who have learnt on its pictures
  ideal           ///< their ideal pictures only: blur then makes one target look like another
};
/// What differs between targets.
enum class TargetCues {
  all,   ///< shape, size and pattern of temperatures
  shape  ///< every view has its dT_RSS all over and the mean size of the set
};

struct IdentificationTask {
  SensorSpec sensor;
  SensorPlan plan;  ///< of the effects
  TemplateObserverSpec observer{};
  Accuracy accuracy{};
  std::vector<IdentificationTarget> targets;
  std::vector<IdentificationRange> ranges;
  TemplateKnowledge knowledge = TemplateKnowledge::behind_camera;
  TargetCues cues = TargetCues::all;
  int decisions = 2000;  ///< for every target at every range, in all aspects together
  /// Turbulence along the path of each range, in place of that of the sensor; 0: as the sensor has it. The plan
  /// simulates it. An observer who knows the targets behind the camera knows them behind the air, too.
  double cn2_m_minus_2_3 = 0;
  std::uint64_t seed = 1;
  std::stop_token stop{};
};

/// The sensor of the task at a range, as the plan has it.
[[nodiscard]] SensorSpec sensor_at(const IdentificationTask& task, double range_m);

struct IdentificationPoint {
  double range_m = 0, transmittance = 1;
  std::vector<std::vector<int>> answers;  ///< [shown][answered]
  /// Share of right answers of each draw of noise, which all targets and aspects share: what is independent.
  std::vector<double> by_draw;
  [[nodiscard]] double proportion() const;
  [[nodiscard]] double standard_error() const;
};

/// What an experiment will take.
struct IdentificationEffort {
  double decisions = 0;      ///< of all targets and ranges
  double largest_bytes = 0;  ///< of the templates of one range
  double processor_s = 0;    ///< on one core of about 2 x 10^10 template samples a second, to a factor of two
};
/// Before anything is computed. Errors: those of identify() that targets are refused with.
[[nodiscard]] Result<IdentificationEffort> planned_effort(const IdentificationTask& task);

/// One point per range, in their order. Every draw of sensor and internal noise is met by every target in every aspect,
/// in one of 16 sampling phases that all draws take in turn; internal noise and the noise that an observer sees
/// enlarged are those of the template observer, the contrast is dT_RSS behind the air. Ranges run on as many threads as
/// there are processors; the result does not depend on their number. Dead detectors are left out; counts are rounded
/// with the noise, not with the signal. `invalid_input`: fewer than two targets, targets that look alike from every
/// side, one without contrast, counts that are too coarse for the noise, targets too large for the observer;
/// `interrupted`.
[[nodiscard]] Result<std::vector<IdentificationPoint>> identify(const IdentificationTask& task);

/// What the camera of the experiment shows: the pictures of identify(), for another observer. Immutable, thread-safe.
class IdentificationFrames {
 public:
  /// Errors: those of identify() that targets are refused with.
  [[nodiscard]] static Result<IdentificationFrames> of(const IdentificationTask& task);
  /// Kelvin above the background on the display, with the noise of this draw and the sampling phase in which the draw
  /// meets this view: identify() of the same task takes the same. All frames of a range have one size.
  [[nodiscard]] cv::Mat1f frame_k(std::size_t range, std::size_t target, std::size_t aspect, std::uint64_t draw) const;
  /// dT_RSS behind the air.
  [[nodiscard]] double contrast_k(std::size_t range, std::size_t target, std::size_t aspect) const;

 private:
  struct Range;
  IdentificationFrames() = default;
  std::vector<std::shared_ptr<const Range>> ranges_;
  std::vector<std::vector<double>> contrasts_k_;  ///< [target][aspect], before the air
};

}  // namespace todbench
