// What an identification experiment says of a set of targets, and whether the TOD curve would have said it.
#pragma once

#include <optional>
#include <vector>

#include "bench/plan/atmospheres.h"
#include "bench/plan/scene_descriptions.h"
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
  int decisions = 2000;        ///< for every target at every range
  double m75 = 5.1;            ///< of the range that is predicted
  double cn2_m_minus_2_3 = 0;  ///< of turbulence along the path of each range; 0: as the sensor has it
  std::uint64_t seed = 1;
  std::stop_token stop{};
};

/// A number with its interval; nothing where the ranges of the experiment do not enclose 75 %.
struct SetCriterion {
  std::optional<double> value;
  Interval ci95;
};

/// Where proportions over something that rises pass 75 %, made monotone (pool adjacent violators), linear in its
/// logarithm; nothing beyond either end.
struct Crossing75 {
  std::optional<double> at;
  bool beyond_last = false;  ///< at least 75 % everywhere
};
[[nodiscard]] Crossing75 crossing_of_75_percent(const std::vector<double>& at, const std::vector<double>& proportions);

struct IdentificationStudy {
  std::vector<IdentificationPoint> points;
  double chance = 0;                         ///< one over the number of targets
  double size_m = 0;                         ///< mean over targets and sides
  double dt_rss_k = 0;                       ///< the same, before the air
  SetCriterion r75_m;                        ///< where 75 % are right; the interval by resampling the draws of noise
  SetCriterion m75, v50;                     ///< of the set: M at r75_m on the TOD curve; M75 / 0.6
  std::vector<TodThreshold> tod;             ///< of the same sensor and observer
  std::optional<RangePrediction> predicted;  ///< by the TOD curve with the m75 of the task; nothing: no curve
  std::vector<std::string> notes;
};

/// The experiment of a study: views, ranges with their air. Errors as study_identification().
[[nodiscard]] Result<IdentificationTask> experiment_of(const IdentificationStudyTask& task);

/// The proportion over range is made monotone (pool adjacent violators) and taken as linear in ln range.
/// `invalid_input`: ranges that do not increase or lie beyond the air's table, and what identify() refuses;
/// `interrupted`.
[[nodiscard]] Result<IdentificationStudy> study_identification(const IdentificationStudyTask& task);

}  // namespace todbench
