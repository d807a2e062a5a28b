// SPDX-License-Identifier: GPL-3.0-or-later
// Simulates an identification experiment with a set of targets, and compares it with the prediction of the TOD curve.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/plan/atmospheres.h"
#include "bench/plan/target_sets.h"
#include "sim_devices/prediction/identification.h"
#include "tod/range/range_prediction.h"

namespace todbench {

struct IdentificationStudyTask {
  TargetSet set;
  SensorSpec sensor;
  TemplateObserverSpec observer{};
  Atmosphere air{};
  Accuracy accuracy{};
  std::vector<double> ranges_m;  ///< at least two, increasing
  TemplateKnowledge knowledge = TemplateKnowledge::behind_camera;
  TargetCues cues = TargetCues::all;
  int decisions = 2000;  ///< per target and range
  double m75 = 5.1;      ///< for the predicted range
  SceneMotion motion{};  ///< of the targets in the picture
  SequenceObserver sequence = SequenceObserver::single_frame;
  int frames = 8;  ///< of a pass
  /// Stages behind the camera, as in IdentificationTask.
  std::function<std::vector<std::unique_ptr<ChainStage>>()> stages{};
  std::optional<int> stage_reach_px{};
  double cn2_m_minus_2_3 = 0;  ///< of turbulence along the path of each range; 0: that of the sensor
  std::uint64_t seed = 1;
  std::stop_token stop{};
};

inline constexpr std::string_view no_r75 = "the ranges do not enclose 75 % correct";
/// A value with its interval; empty if the ranges of the experiment do not enclose 75 %.
struct SetCriterion {
  std::optional<double> value;
  Interval ci95;
  /// Smallest and largest of three values: that of an observer with an eye and those at both ends of its open
  /// parameters (open_parameters.h). Empty if one has no value. No confidence interval.
  std::optional<std::pair<double, double>> spread{};
};

/// Position at which rising proportions cross 75 %, made monotone (pool adjacent violators), linear in the logarithm of
/// the position; empty beyond either end.
struct Crossing75 {
  std::optional<double> at;
  bool beyond_last = false;  ///< at least 75 % everywhere
};
[[nodiscard]] Crossing75 crossing_of_75_percent(const std::vector<double>& at, const std::vector<double>& proportions);

struct IdentificationStudy {
  std::vector<IdentificationPoint> points;
  double chance = 0;              ///< 1 / number of targets
  double size_m = 0;              ///< mean over targets and aspects
  double dt_rss_k = 0;            ///< mean over targets and aspects, before the air
  SetCriterion r75_m;             ///< range with 75 % right; the interval by resampling the draws of noise
  SetCriterion m75, v50;          ///< of the set: M at r75_m on the TOD curve; M75 / 0.6
  std::string no_m75_because;     ///< empty with an M75
  std::vector<TodThreshold> tod;  ///< of the same sensor and observer
  /// S75 of each point of `tod` over the open parameters of an observer with an eye; empty where an end has none.
  std::vector<std::optional<std::pair<double, double>>> tod_spread_mrad;
  std::optional<RangePrediction> predicted;  ///< by the TOD curve with the m75 of the task; empty: no curve
  /// Of the predicted range, as SetCriterion::spread.
  std::optional<std::pair<double, double>> predicted_spread_m;
  std::vector<std::string> notes;
};

/// Returns the experiment of a study: views, ranges with their air. Errors: those of study_identification().
[[nodiscard]] Result<IdentificationTask> experiment_of(const IdentificationStudyTask& task);

/// Criteria of the set for a range with 75 % right that others found, for example people: M75 and V50 on the TOD curve
/// of the observer of the task, and the predicted range. `points` is empty. Errors: those of study_identification().
[[nodiscard]] Result<IdentificationStudy> rate_found_range(const IdentificationStudyTask& task,
                                                           const SetCriterion& r75_m);

/// Runs the study. The proportion over range is made monotone (pool adjacent violators) and interpolated linearly in ln
/// range. The TOD curve is that of a single frame in the same motion. With stages, with sums of frames, and with motion
/// through turbulent paths there is no curve, and a note says so. Errors: `invalid_input` (ranges that do not increase
/// or exceed the air's table; those of identify()), `interrupted`.
[[nodiscard]] Result<IdentificationStudy> study_identification(const IdentificationStudyTask& task);

}  // namespace todbench
