// SPDX-License-Identifier: GPL-3.0-or-later
// Experiment with a person in place of the observer of `identify` or `mrtd`: the same frames in sequence, each with its
// alternatives.
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/session/human_record.h"
#include "bench/studies/identification_study.h"
#include "bench/text/json.h"
#include "sim_devices/prediction/virtual_mrtd.h"

namespace todbench {

/// Task of the person.
enum class PersonTask {
  identify,  ///< question about one picture: which target of the set is it?
  /// Question by BarCriterion: which of two pictures has the four bars, or: are the bars of one picture resolved (yes
  /// or no)?
  bars
};
/// Returns the name of the task, "identify" or "mrtd".
[[nodiscard]] std::string_view to_string(PersonTask task);

/// Properties that several trials share.
struct PersonCondition {
  double range_m = 0, transmittance = 1;  ///< range and transmittance of the air, for `identify`
  double frequency_per_mrad = 0;          ///< frequency of the bars
  double contrast_k = 0;  ///< contrast of the bars, or the mean dT_RSS of the set, attenuated by the air
  std::size_t place = 0;  ///< index of range or frequency in the task
};

/// One question. The task with its seed reproduces its picture.
struct PersonTrial {
  std::size_t condition = 0;
  std::size_t truth = 0;   ///< index of the alternative; for `bars_resolved` 1 if no bars are shown
  std::size_t aspect = 0;  ///< index of the view of the target, for `identify`
  std::size_t phase = 0;   ///< phase of the bars; for `identify` the phase follows from the draw
  /// Number of the noise draw. For bars, the left interval uses this number and the right interval uses the next
  /// number.
  std::uint64_t draw = 0;
};

/// Levels displayed as black and as white, in kelvin above the background.
struct GreyScale {
  double black_k = -1, white_k = 1;
};

/// Trials of an experiment, with their pictures.
class PersonExperiment {
 public:
  /// Shows every target `per_target` times at every range, each time from one of its aspects and with its own noise, in
  /// random order. Errors: those of experiment_of() and IdentificationFrames::of().
  [[nodiscard]] static Result<PersonExperiment> of_set(const IdentificationStudyTask& task, int per_target);
  /// Shows bars by the criterion of the task: six contrasts, `per_contrast` times each. The contrasts start at twice
  /// the threshold of an ideal observer, in steps of a factor of 1.6. For `bars_resolved` the factor is 2. For every
  /// three frames of a contrast there is one frame without bars on the same grey scale. Errors: those of
  /// BarFrames::of().
  [[nodiscard]] static Result<PersonExperiment> of_bars(const VirtualMrtdTask& task, int per_contrast);

  [[nodiscard]] PersonTask task() const { return task_; }
  /// Returns the criterion. Only used for bars.
  [[nodiscard]] BarCriterion criterion() const { return criterion_; }
  [[nodiscard]] const std::vector<std::string>& alternatives() const { return alternatives_; }
  /// Returns a small picture of every alternative, 0 black to 1 white.
  [[nodiscard]] const std::vector<cv::Mat1d>& icons() const { return icons_; }
  [[nodiscard]] const std::vector<PersonCondition>& conditions() const { return conditions_; }
  [[nodiscard]] const std::vector<PersonTrial>& trials() const { return trials_; }
  /// Returns the shown picture in kelvin above the background; for two intervals both pictures, separated by a strip of
  /// background. Errors: those of stages after the camera.
  [[nodiscard]] Result<cv::Mat1f> picture_k(const PersonTrial& trial) const;
  /// Returns the grey scale, which is the same for all trials of a condition and thus does not depend on the answer.
  [[nodiscard]] GreyScale grey(const PersonTrial& trial) const { return grey_[trial.condition]; }
  /// Returns sensor, set or axis, and seed, for the record.
  [[nodiscard]] const Json& description() const { return description_; }

 private:
  PersonExperiment() noexcept(false) = default;  // the constructor of Json may throw
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

/// Answer of a person to one trial.
struct ExperimentAnswer {
  std::size_t answer = 0;
  double response_s = 0;  ///< time from display to answer
  std::optional<int> limit_ms{};
};

/// Correct answers of one condition, with Wilson's 95 % interval. For `bars_resolved`, only frames with bars are
/// counted.
struct PersonShare {
  int shown = 0, right = 0;
  Interval ci95;
};

/// Evaluation of the answers. The 75 % values are crossings as in Crossing75. The intervals of these values come from
/// resampling the answers of every condition.
struct PersonResult {
  std::vector<PersonShare> conditions;                   ///< share of correct answers, by condition
  std::vector<std::vector<std::vector<int>>> confusion;  ///< [condition][shown][answered]
  SetCriterion r75_m;                                    ///< range with 75 % correct, for `identify`
  /// Bars: threshold of every frequency. For `bars_resolved`, empty if the person reported bars in more than a quarter
  /// of the frames without bars. The threshold of a person who always answers yes is meaningless.
  std::vector<SetCriterion> thresholds_k;
  /// For `bars_resolved`: number of frames without bars at every frequency, and number of yes answers to these frames.
  std::vector<PersonShare> false_alarms;
};
/// Evaluates the first answers.size() trials.
[[nodiscard]] PersonResult person_result(const PersonExperiment& experiment,
                                         const std::vector<ExperimentAnswer>& answers);

/// Writes person.json and answers.csv into a new folder. person.json contains the facts about the person, and results
/// under the same keys as the output of `identify` or `mrtd`. Errors: `invalid_input` if the folder exists; `io` with
/// the path.
[[nodiscard]] Result<void> write_person(const std::filesystem::path& folder, const PersonExperiment& experiment,
                                        const std::vector<ExperimentAnswer>& answers, const PersonFacts& person,
                                        bool complete);

}  // namespace todbench
