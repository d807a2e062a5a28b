// SPDX-License-Identifier: GPL-3.0-or-later
// Simulated identification experiment with a set of targets, and the prediction of its result from the TOD curve.
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

/// Experiment to simulate.
struct IdentificationStudyTask {
  /// Targets that the observer discriminates.
  TargetSet set;
  /// Sensor that shows the targets.
  SensorSpec sensor;
  /// Observer of the experiment and of the TOD curve.
  TemplateObserverSpec observer{};
  /// Air between targets and sensor.
  Atmosphere air{};
  /// Numerical accuracy of the simulation.
  Accuracy accuracy{};
  /// Ranges of the experiment, at least two, increasing. The ranges should enclose 75 % correct.
  std::vector<double> ranges_m;
  /// Pictures that the observer uses as templates.
  TemplateKnowledge knowledge = TemplateKnowledge::behind_camera;
  /// Differences between the targets that the experiment shows.
  TargetCues cues = TargetCues::all;
  /// Decisions per target and range. More decisions narrow the intervals.
  int decisions = 2000;
  /// M75 with which the TOD curve predicts the range.
  double m75 = 5.1;
  /// Motion of the targets across the picture.
  SceneMotion motion{};
  /// Use of the frames of a pass by the observer.
  SequenceObserver sequence = SequenceObserver::single_frame;
  /// Number of frames of a pass.
  int frames = 8;
  /// Stages after the camera, as in IdentificationTask.
  std::function<std::vector<std::unique_ptr<ChainStage>>()> stages{};
  /// Largest distance over which the stages spread a picture, as in IdentificationTask.
  std::optional<int> stage_reach_px{};
  /// Structure parameter Cn2 of the turbulence along the path of each range; 0: value of the sensor.
  double cn2_m_minus_2_3 = 0;
  /// Seed of all random numbers.
  std::uint64_t seed = 1;
  std::stop_token stop{};
};

/// Reason for a missing range with 75 % correct.
inline constexpr std::string_view no_r75 = "the ranges do not enclose 75 % correct";
/// A value with its interval; empty if the ranges of the experiment do not enclose 75 %.
struct SetCriterion {
  std::optional<double> value;
  Interval ci95;
  /// Smallest and largest of three values of an observer with an eye: one with the nominal parameters, and one at each
  /// limit of its open parameters (open_parameters.h). Empty if one of the three is missing. Not a confidence interval.
  std::optional<std::pair<double, double>> spread{};
};

/// Position at which rising proportions cross 75 %. The proportions are made monotone (pool adjacent violators) and
/// interpolated linearly in the logarithm of the position. Empty if the crossing is outside the positions.
struct Crossing75 {
  std::optional<double> at;
  bool beyond_last = false;  ///< the proportion is at least 75 % at every position
  /// Possible error of the interpolation, in ln position: 1.7 times the distance to the crossing of a logistic
  /// function of ln position through the same two proportions. Small if the positions beside the crossing are close to
  /// each other.
  double interpolation_ln = 0;
};
/// Returns the crossing of these proportions.
[[nodiscard]] Crossing75 crossing_of_75_percent(const std::vector<double>& at, const std::vector<double>& proportions);
/// Returns the crossing with the 95 % interval of the crossings of resampled proportions. Each side also contains the
/// error of the interpolation, in quadrature.
[[nodiscard]] SetCriterion with_interval(const Crossing75& found, const std::vector<Crossing75>& resampled);

/// Result of the study.
struct IdentificationStudy {
  std::vector<IdentificationPoint> points;
  double chance = 0;              ///< 1 / number of targets
  double size_m = 0;              ///< size of a target, mean over targets and aspects
  double dt_rss_k = 0;            ///< root-sum-square contrast, mean over targets and aspects, before the air
  SetCriterion r75_m;             ///< range with 75 % correct; the interval comes from resampling the draws of noise
  SetCriterion m75, v50;          ///< criteria of the set: M75 is M at r75_m on the TOD curve, and V50 is M75 / 0.6
  std::string no_m75_because;     ///< reason for a missing M75; empty: there is an M75
  std::vector<TodThreshold> tod;  ///< TOD curve of the same sensor and observer
  /// S75 of each point of `tod` over the open parameters of an observer with an eye; empty if there is no S75 at a
  /// limit of the parameters.
  std::vector<std::optional<std::pair<double, double>>> tod_spread_mrad;
  std::optional<RangePrediction> predicted;  ///< predicted from the TOD curve with the m75 of the task; empty: no curve
  /// Spread of the predicted range, as SetCriterion::spread.
  std::optional<std::pair<double, double>> predicted_spread_m;
  std::vector<std::string> notes;
};

/// Returns the experiment of a study: views, ranges with their air. Errors: those of study_identification().
[[nodiscard]] Result<IdentificationTask> experiment_of(const IdentificationStudyTask& task);

/// Returns the criteria of the set for a range with 75 % correct from a different experiment, for example with people.
/// The criteria are M75 and V50 on the TOD curve of the observer of the task, and the predicted range. `points` is
/// empty. Errors: those of study_identification().
[[nodiscard]] Result<IdentificationStudy> rate_found_range(const IdentificationStudyTask& task,
                                                           const SetCriterion& r75_m);

/// Runs the study. The proportion over range is made monotone (pool adjacent violators) and interpolated linearly in ln
/// range. The TOD curve is valid for a single frame in the same motion. There is no curve with stages, with sums of
/// frames, or with motion through turbulent paths; a note states this. Errors: `invalid_input` (ranges that do not
/// increase, or that exceed the table of the air), those of identify(), `interrupted`.
[[nodiscard]] Result<IdentificationStudy> study_identification(const IdentificationStudyTask& task);

}  // namespace todbench
