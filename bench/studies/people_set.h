// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of an identification experiment for people: a folder of pictures in random order, their truth in a separate
// folder, and the answers.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/studies/person_experiment.h"

namespace todbench {

/// Returns the number of an experiment: 12 hexadecimal digits of a hash. The hash covers description, alternatives,
/// trials, and the contrast of one picture at every range. A different sensor, air, motion or package therefore gives a
/// different number. Errors: those of PersonExperiment::picture_k().
[[nodiscard]] Result<std::string> people_set_number(const PersonExperiment& experiment);

/// Encodes a grey picture as PNG.
using PngEncoder = std::function<Result<std::string>(const cv::Mat1b& picture)>;
/// Writes into a new folder: show/NUMBER.png, show/targets/NAME.png and show/answers.csv (with an empty column
/// `answer`), and for the experimenter truth/truth.csv and truth/experiment.json. All pictures of a range have the same
/// grey scale. Errors: `invalid_input` if the folder exists; `io` with the path.
[[nodiscard]] Result<void> write_people_set(const std::filesystem::path& folder, const PersonExperiment& experiment,
                                            const PngEncoder& png);

/// Reads a filled answers.csv. Errors: `invalid_input` "FILE:LINE: ..." (a missing column, a missing or unknown answer,
/// a repeated or missing picture, answers of a different experiment).
[[nodiscard]] Result<std::vector<ExperimentAnswer>> read_people_answers(const std::filesystem::path& file,
                                                                        const PersonExperiment& experiment);

/// Answers of all people at one range. The interval is Wilson's interval for an effective number of independent
/// answers, which explains the scatter between people. For one person, or if the scatter is smaller than expected by
/// chance, the number of answers replaces the effective number.
struct PeopleShare {
  int shown = 0, right = 0;
  Interval ci95;
};
/// Evaluation of the answers of all people.
struct PeopleResult {
  std::vector<PersonResult> persons;
  std::vector<PeopleShare> ranges;
  /// Range with 75 % correct. One person: as PersonResult. Several people: mean of the logarithms, with Hartung and
  /// Knapp's interval (people.h); empty if fewer than two people have a range with an interval.
  SetCriterion r75_m;
  /// Standard deviation of ln R75 between people, without the errors of the single values.
  std::optional<double> between_sd;
};
/// Evaluates the answers. Precondition: there is at least one person, and every person answered every trial.
[[nodiscard]] PeopleResult people_result(const PersonExperiment& experiment,
                                         const std::vector<std::vector<ExperimentAnswer>>& persons);

/// M75 of a set in a file, with the observer of the answers and the observer of the TOD curve.
struct StatedM75 {
  std::string set, answers_of, curve_of;
  double m75 = 0;
  Interval ci95;
};
/// Writes the file. Errors: `io`.
[[nodiscard]] Result<void> write_m75_file(const std::filesystem::path& file, const StatedM75& m75);
/// Reads the file. Errors: `invalid_input` with the file (no such file, a different schema, values outside 1e-6 to
/// 1e6).
[[nodiscard]] Result<StatedM75> read_m75_file(const std::filesystem::path& file);

}  // namespace todbench
