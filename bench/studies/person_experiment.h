// A person in place of the observer of `identify` or `mrtd`: the same frames, one after the other, each with the
// alternatives that it can be.
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/studies/identification_study.h"
#include "bench/text/json.h"
#include "sim_devices/prediction/virtual_mrtd.h"

namespace todbench {

enum class PersonTask {
  identify,  ///< one picture: which target of the set is it?
  bars       ///< by BarCriterion: which of two pictures has the four bars? Or yes or no of one: are they resolved?
};
[[nodiscard]] std::string_view to_string(PersonTask task);

/// What is the same for some of the trials.
struct PersonCondition {
  double range_m = 0, transmittance = 1;  ///< identify
  double frequency_per_mrad = 0;          ///< bars
  double contrast_k = 0;                  ///< of the bars, or the mean dT_RSS of the set behind the air
  std::size_t place = 0;                  ///< of range or frequency in the task
};

/// One question. Everything that its picture is made of: the task with its seed makes it again.
struct PersonTrial {
  std::size_t condition = 0;
  std::size_t truth = 0;   ///< of the alternatives; of `bars_resolved` 1 where nothing is shown
  std::size_t aspect = 0;  ///< identify
  std::size_t phase = 0;   ///< bars; of identify the draw says it
  std::uint64_t draw = 0;  ///< of noise; bars: of the left interval, the right one has the next
};

/// Ends of the grey scale, kelvin above the background.
struct GreyScale {
  double black_k = -1, white_k = 1;
};

class PersonExperiment {
 public:
  /// Every target `per_target` times at every range, each time from one of its sides and with noise of its own, all in
  /// random order. Errors: experiment_of(), IdentificationFrames::of().
  [[nodiscard]] static Result<PersonExperiment> of_set(const IdentificationStudyTask& task, int per_target);
  /// By the criterion of the task. Six contrasts, `per_contrast` times each, from twice the threshold of an ideal
  /// observer in steps of 1.6; of `bars_resolved` in steps of 2, and for every three frames of a contrast one with
  /// nothing in it, on the same grey scale. Errors: BarFrames::of().
  [[nodiscard]] static Result<PersonExperiment> of_bars(const VirtualMrtdTask& task, int per_contrast);

  [[nodiscard]] PersonTask task() const { return task_; }
  /// Of bars.
  [[nodiscard]] BarCriterion criterion() const { return criterion_; }
  [[nodiscard]] const std::vector<std::string>& alternatives() const { return alternatives_; }
  /// A small picture of every alternative, 0 black to 1 white.
  [[nodiscard]] const std::vector<cv::Mat1d>& icons() const { return icons_; }
  [[nodiscard]] const std::vector<PersonCondition>& conditions() const { return conditions_; }
  [[nodiscard]] const std::vector<PersonTrial>& trials() const { return trials_; }
  /// What is shown, kelvin above the background; of bars both intervals, a strip of background between them, where
  /// there are two.
  [[nodiscard]] cv::Mat1f picture_k(const PersonTrial& trial) const;
  /// The same for all trials of a condition: nothing depends on the answer.
  [[nodiscard]] GreyScale grey(const PersonTrial& trial) const { return grey_[trial.condition]; }
  /// Sensor, set or axis, seed, for the record.
  [[nodiscard]] const Json& description() const { return description_; }

 private:
  PersonExperiment() noexcept(false) = default;  // that of Json may throw
  void shuffle(std::uint64_t seed);
  void describe_bars();
  PersonTask task_ = PersonTask::identify;
  BarCriterion criterion_ = BarCriterion::four_or_five;
  std::vector<std::string> alternatives_;
  std::vector<cv::Mat1d> icons_;
  std::vector<PersonCondition> conditions_;
  std::vector<PersonTrial> trials_;
  std::vector<GreyScale> grey_;
  std::optional<IdentificationFrames> frames_;
  std::optional<BarFrames> bars_;
  Json description_;
};

struct PersonAnswer {
  std::size_t answer = 0;
  double response_s = 0;  ///< from showing to answering
  std::optional<int> limit_ms{};
};

/// Right answers of one condition, with Wilson's 95 % interval; of `bars_resolved` to frames with bars only.
struct PersonShare {
  int shown = 0, right = 0;
  Interval ci95;
};

/// What the answers say. 75 % is where proportions, made monotone, pass it, linear in the logarithm; the interval by
/// resampling the answers of every condition.
struct PersonResult {
  std::vector<PersonShare> conditions;                   ///< in their order
  std::vector<std::vector<std::vector<int>>> confusion;  ///< [condition][shown][answered]
  SetCriterion r75_m;                                    ///< identify
  /// Bars: of every frequency. Nothing by `bars_resolved` where bars were seen in more than a quarter of the frames
  /// without any: whoever says yes to everything has no threshold.
  std::vector<SetCriterion> thresholds_k;
  /// `bars_resolved`: of every frequency, how many frames without bars there were and in how many bars were seen.
  std::vector<PersonShare> false_alarms;
};
/// Of the first answers.size() trials.
[[nodiscard]] PersonResult person_result(const PersonExperiment& experiment, const std::vector<PersonAnswer>& answers);

/// person.json (the keys of `identify` or `mrtd` where they mean the same) and answers.csv into a new folder.
/// `invalid_input` where it exists; `io` with the path.
[[nodiscard]] Result<void> write_person(const std::filesystem::path& folder, const PersonExperiment& experiment,
                                        const std::vector<PersonAnswer>& answers, bool complete);

}  // namespace todbench
